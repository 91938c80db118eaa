"""Frames from pictures, videos, a camera or an array in memory, with the lens distortion taken out if need be."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import cv2
import numpy as np

from signum.common.arrays import Image
from signum.common.errors import SourceError
from signum.frames.frame import Frame, Source, read_picture, size_text
from signum.geometry.calibration import CalibrationError, read_mono

PICTURES = frozenset({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm", ".ppm", ".webp"})
"""A file with one of these endings is a picture."""


class FolderSource(Source):
    """A folder of pictures in natural order of their names (2 before 10)."""

    snapshots = True

    def __init__(self, folder: Path) -> None:
        pictures = (f for f in folder.iterdir() if f.suffix.lower() in PICTURES and not f.name.startswith("."))
        self.files = sorted(pictures, key=lambda f: _natural(f.name))
        if not self.files:
            raise SourceError(f"{folder}: no pictures in this folder; signum reads {' '.join(sorted(PICTURES))}")
        seen: dict[str, Path] = {}
        for f in self.files:
            if f.stem in seen:
                raise SourceError(f"{folder}: {seen[f.stem].name} and {f.name} would both be frame {f.stem}; "
                                  "rename or move one of them")
            seen[f.stem] = f
        super().__init__(str(folder), len(self.files))

    def _frames(self) -> Iterator[Frame]:
        return (Frame(f.stem, read_picture(f)) for f in self.files)


class PictureSource(Source):
    """A single picture."""

    snapshots = True

    def __init__(self, file: Path) -> None:
        super().__init__(str(file), 1)
        self.file = file

    def _frames(self) -> Iterator[Frame]:
        yield Frame(self.file.stem, read_picture(self.file))


class VideoSource(Source):
    """A video file of any kind that OpenCV decodes."""

    def __init__(self, file: Path) -> None:
        self.file = file
        capture = self._open()
        count = round(capture.get(cv2.CAP_PROP_FRAME_COUNT))
        capture.release()
        super().__init__(str(file), count if count > 0 else None)

    def _open(self) -> cv2.VideoCapture:
        capture = cv2.VideoCapture(str(self.file))
        if not capture.isOpened():
            raise SourceError(f"{self.file}: not a video that can be decoded (empty, cut short or of an unknown kind); "
                              f"try `ffmpeg -i {self.file.name} -c:v libx264 mended.mp4`")
        return capture

    def _frames(self) -> Iterator[Frame]:
        capture = self._open()
        done = 0
        try:
            while True:
                good, picture = capture.read()
                if not good:
                    break
                yield Frame(str(done), np.asarray(picture, np.uint8))
                done += 1
        finally:
            capture.release()
        # A container's count may be off by a few frames; if a tenth is missing, the file was cut short.
        if self.count is not None and 0 < done < 0.9 * self.count - 1:
            raise SourceError(f"{self.file}: broken after frame {done - 1} of {self.count}; what came before is kept; "
                              f"mend the file with `ffmpeg -i {self.file.name} -c:v libx264 mended.mp4`")


class CameraSource(Source):
    """A live camera by its OpenCV index, until the camera delivers no more frames."""

    def __init__(self, index: int) -> None:
        super().__init__(f"camera {index}", None)
        self.index = index

    def _frames(self) -> Iterator[Frame]:
        capture = cv2.VideoCapture(self.index)
        if not capture.isOpened():
            raise SourceError(f"{self.label}: cannot be opened; list the cameras with `ls /dev/video*`")
        try:
            done = 0
            while True:
                good, picture = capture.read()
                if not good:
                    return
                yield Frame(str(done), np.asarray(picture, np.uint8))
                done += 1
        finally:
            capture.release()


class ArraySource(Source):
    """Camera frames held in an array: a sequence of pictures, or a .npy file of uint8 (N, H, W) or (N, H, W, 3)."""

    def __init__(self, pictures: Sequence[Image] | Image, label: str = "array") -> None:
        super().__init__(label, len(pictures))
        self.pictures = pictures

    @classmethod
    def load(cls, file: Path) -> ArraySource:
        """Read a .npy file.

        Raises:
            SourceError: if it is not such an array.
        """
        try:
            data = np.load(file, mmap_mode="r", allow_pickle=False)
        except (ValueError, OSError, EOFError) as error:
            raise SourceError(f"{file}: not a NumPy array file; save the frames with `numpy.save`") from error
        if data.dtype != np.uint8 or data.ndim not in (3, 4) or (data.ndim == 4 and data.shape[3] != 3):
            raise SourceError(f"{file}: {data.dtype} array of shape {data.shape}; "
                              "frames are uint8 (N, H, W) or (N, H, W, 3)")
        return cls(data, str(file))

    def _frames(self) -> Iterator[Frame]:
        for index in range(len(self.pictures)):
            yield Frame(str(index), np.ascontiguousarray(self.pictures[index]))


class UndistortedSource(Source):
    """Frames of another source as a camera without lens distortion, of the same size and focal length, sees them."""

    def __init__(self, source: Source, calibration: Path) -> None:
        super().__init__(source.label, source.count)
        self.source, self.snapshots, self.calibration = source, source.snapshots, calibration
        self._matrix, self._distortion, self._size = read_mono(calibration)

    def _frames(self) -> Iterator[Frame]:
        maps = cv2.initUndistortRectifyMap(self._matrix, self._distortion, np.eye(3), self._matrix, self._size,
                                           cv2.CV_32FC1)
        for frame in self.source:
            if frame.size != self._size:
                raise CalibrationError(f"{self.calibration}: is for {size_text(self._size)}, frame {frame.name} is "
                                       f"{size_text(frame.size)}: use the calibration of this camera at this size")
            yield Frame(frame.name, np.asarray(cv2.remap(frame.picture, *maps, cv2.INTER_LINEAR), np.uint8))


def _natural(name: str) -> list[tuple[int, int, str]]:
    return [(0, int(part), "") if part.isdigit() else (1, 0, part.lower()) for part in re.split(r"(\d+)", name) if part]
