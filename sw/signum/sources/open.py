"""Where frames come from: a folder of pictures, one picture, a video, a ROS bag, a camera, an array in memory, the
simulated world; lens distortion is taken out where a calibration is at hand.

A frame's name is its file's name without the ending for pictures, the index from 0 for everything else; it is what
the tables call `frame`. All frames of a source have one size. A frame that cannot be used raises SourceError when its
turn comes, so that what was finished before can be kept.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage
from PIL import UnidentifiedImageError

from golden.params import Config
from signum.geometry.calibration import CalibrationError, read_mono
from signum.common.errors import SourceError

Picture = NDArray[np.uint8]
"""uint8, (H, W) grey or (H, W, 3) blue, green, red."""

PICTURES = frozenset({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm", ".ppm", ".webp"})
VIDEOS = frozenset({".mp4", ".avi", ".mov", ".mkv", ".m4v", ".mpg", ".mpeg", ".webm", ".ts", ".wmv"})
BAGS = frozenset({".bag", ".mcap", ".db3"})
CAMERA = re.compile(r"(?:camera:)?(\d{1,2})$")
WORLD = re.compile(r"world(?::|$)")

# OpenCV's own chatter about odd TIFF tags would bury our one line.
PilImage.MAX_IMAGE_PIXELS = None
cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_ERROR)


@dataclass(frozen=True)
class Frame:
    """One picture of a source."""

    name: str
    picture: Picture

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self.picture.shape[1], self.picture.shape[0]

    @property
    def grey(self) -> Picture:
        """uint8 (H, W)."""
        return grey(self.picture)


def grey(picture: Picture) -> Picture:
    """A picture without its colour: uint8 (H, W)."""
    return picture if picture.ndim == 2 else np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8)


class Source(ABC):
    """An ordered run of frames of one size."""

    snapshots = False
    """True where frames are pictures taken apart from one another, rather than a stream in which little moves between
    two."""

    def __init__(self, label: str, count: int | None) -> None:
        self.label = label
        """What to call it in messages."""
        self.count = count
        """Number of frames, where it is known."""

    @abstractmethod
    def _frames(self) -> Iterator[Frame]: ...

    def __iter__(self) -> Iterator[Frame]:
        """The frames, in order.

        Raises:
            SourceError: at the first frame that cannot be used.
        """
        first: Frame | None = None
        for frame in self._frames():
            first = first or frame
            if frame.size != first.size:
                raise SourceError(
                    f"{self.label}: frame {frame.name} is {_by(frame.size)}, frame {first.name} is {_by(first.size)}: "
                    "all frames must have one size; crop or scale the odd ones, or put them in a folder of their own")
            yield frame
        if first is None:
            raise SourceError(f"{self.label}: no frames in it; give a folder of pictures or a video that plays")


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
    """A video file, as far as OpenCV's decoders go."""

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
        # A container's count may be off by a few frames; a tenth missing is a file cut short.
        if self.count is not None and 0 < done < 0.9 * self.count - 1:
            raise SourceError(f"{self.file}: broken after frame {done - 1} of {self.count}; what came before is kept; "
                              f"mend the file with `ffmpeg -i {self.file.name} -c:v libx264 mended.mp4`")


class CameraSource(Source):
    """A live camera by its OpenCV index; ends when stopped or when the camera does."""

    def __init__(self, index: int) -> None:
        super().__init__(f"camera {index}", None)
        self.index = index

    def _frames(self) -> Iterator[Frame]:
        capture = cv2.VideoCapture(self.index)
        if not capture.isOpened():
            raise SourceError(f"{self.label}: cannot be opened; see which there are with `ls /dev/video*`")
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

    def __init__(self, pictures: Sequence[Picture] | NDArray[np.uint8], label: str = "array") -> None:
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
                raise CalibrationError(f"{self.calibration}: is for {_by(self._size)}, frame {frame.name} is "
                                       f"{_by(frame.size)}: use the calibration of this camera at this size")
            yield Frame(frame.name, np.asarray(cv2.remap(frame.picture, *maps, cv2.INTER_LINEAR), np.uint8))


def open_source(text: str | Path, calibration: Path | None = None) -> Source:
    """The source a user names: a folder, a picture, a video, a .npy array, a ROS bag (`dive.bag`, `dive.mcap`, a bag's
    folder, with `#topic` behind it if it has several), `world` (simulated) or a camera's number (`0` or `camera:0`).

    Args:
        text: the name.
        calibration: OpenCV YAML of the camera, whose distortion is taken out; None for none.

    Raises:
        SourceError: if there is no such thing, or it is plainly unusable.
        CalibrationError: if the calibration is.
    """
    source = _open(text)
    return source if calibration is None else UndistortedSource(source, calibration)


def _open(text: str | Path) -> Source:
    file, _, topic = str(text).partition("#")
    if _is_bag(Path(file)):
        from signum.sources.bags import BagSource  # imports this module, and takes a while itself

        return BagSource(Path(file), topic or None)
    if WORLD.match(str(text)) and not Path(text).exists():
        from signum.sources.simulated import WorldSource  # imports this module

        return WorldSource.named(str(text))
    path = Path(text)
    if path.is_dir():
        return FolderSource(path)
    if not path.exists():
        camera = CAMERA.match(str(text))
        if camera:
            return CameraSource(int(camera[1]))
        raise SourceError(f"{path}: no such file or folder; check the spelling (here is {Path.cwd()})")
    if not path.stat().st_size:
        raise SourceError(f"{path}: the file is empty; copy or record it again")
    kind = path.suffix.lower()
    if kind in PICTURES:
        return PictureSource(path)
    if kind == ".npy":
        return ArraySource.load(path)
    return VideoSource(path)


def _is_bag(path: Path) -> bool:
    """Whether a path is a ROS bag: by its ending, or a ROS 2 bag's folder."""
    return (path.is_file() and path.suffix.lower() in BAGS) or (path / "metadata.yaml").is_file()


def read_picture(file: Path) -> Picture:
    """Read an 8-bit picture, grey or colour.

    Raises:
        SourceError: if it is missing, broken, cut short, or not 8-bit.
    """
    if not file.exists():
        raise SourceError(f"{file}: no such file; check the spelling")
    try:  # OpenCV returns the part it could decode of a file cut short; Pillow says so
        with PilImage.open(file) as check:
            check.load()
    except UnidentifiedImageError:
        pass
    except (OSError, SyntaxError) as error:
        raise SourceError(f"{file}: broken or cut short; copy it again or take it out") from error
    raw = cv2.imread(str(file), cv2.IMREAD_UNCHANGED)
    if raw is None:
        raise SourceError(f"{file}: cannot be read: not a picture, or broken; copy it again or take it out")
    if raw.dtype != np.uint8:
        bits = 8 * raw.dtype.itemsize
        raise SourceError(f"{file}: a {bits}-bit picture; signum takes 8-bit grey or colour: "
                          f"convert it, e.g. `convert {file.name} -normalize -depth 8 {file.stem}_8bit.png`")
    if raw.ndim == 3 and raw.shape[2] == 4:
        raw = raw[:, :, :3]
    elif raw.ndim == 3 and raw.shape[2] != 3:
        raw = raw[:, :, 0]
    return np.ascontiguousarray(raw, np.uint8)


@dataclass(frozen=True)
class Fit:
    """How a source's frames are shown to the board: scaled down, where they are larger, to the size the board takes.

    Positions are pixel centres: (0, 0) is the centre of the top left pixel in both pictures.
    """

    source: tuple[int, int]
    """Width and height of the original, pixels."""
    board: tuple[int, int]
    """Width and height as the board sees it, pixels."""

    @classmethod
    def to(cls, size: tuple[int, int], config: Config, window: int, label: str = "frame") -> Fit:
        """The fit of `size` (width, height) to a board.

        Args:
            size: of the original, pixels.
            config: the board's build.
            window: side of the correlation window, pixels of the board's image, which must fit in.
            label: what to call the frame in the error.

        Raises:
            SourceError: if the frame is too small for the window or for the board.
        """
        width, height = size
        scale = min(1.0, config.max_width / width, config.max_height / height)
        board = (max(1, round(width * scale)), max(1, round(height * scale)))
        least = max(window, config.min_image)
        if min(board) < least:
            seen = "" if board == size else f" ({_by(board)} on the board)"
            remedy = (f"choose a smaller one, e.g. --window {max(config.min_window, min(board) // 2)}"
                      if min(board) >= config.min_image else f"the board takes {_by((config.min_image,) * 2)} or more")
            raise SourceError(f"{label}: {_by(size)} pixels{seen} is smaller than the {_by((least, least))} window: "
                              f"{remedy}")
        return cls(size, board)

    def coarser(self, longest: int) -> Fit:
        """The same frames with a longer side of at most `longest` pixels on the board."""
        scale = min(1.0, longest / max(self.board))
        return Fit(self.source, (max(1, round(self.board[0] * scale)), max(1, round(self.board[1] * scale))))

    @property
    def factor(self) -> tuple[float, float]:
        """Original pixels per pixel of the board, across and down; 1 or more."""
        return self.source[0] / self.board[0], self.source[1] / self.board[1]

    @property
    def scaled(self) -> bool:
        """Whether the frames are scaled at all."""
        return self.source != self.board

    def show(self, picture: Picture) -> Picture:
        """The frame for the board: grey uint8 (board height, board width)."""
        image = grey(picture)
        if not self.scaled:
            return np.ascontiguousarray(image)
        return np.asarray(cv2.resize(image, self.board, interpolation=cv2.INTER_AREA), np.uint8)

    def to_source(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Positions (..., 2) of the board's image in original pixels."""
        k = np.array(self.factor)
        return np.asarray((points + 0.5) * k - 0.5, np.float64)

    def to_board(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Positions (..., 2) of the original in pixels of the board's image."""
        k = np.array(self.factor)
        return np.asarray((points + 0.5) / k - 0.5, np.float64)

    def note(self) -> str:
        """One line for the user where frames are scaled, else empty."""
        if not self.scaled:
            return ""
        return (f"frames of {_by(self.source)} are scaled to {_by(self.board)} for the board; "
                "figures are in original pixels")


def _by(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"


def _natural(name: str) -> list[tuple[int, int, str]]:
    return [(0, int(part), "") if part.isdigit() else (1, 0, part.lower()) for part in re.split(r"(\d+)", name) if part]
