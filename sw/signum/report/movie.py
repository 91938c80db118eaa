# SPDX-License-Identifier: Apache-2.0
"""MP4 files written frame by frame, complete once they are closed.

OpenCV's writer says nothing when the disk is full, so a closed film is counted before it takes its name.
"""

from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np

from signum.common.arrays import Image
from signum.common.errors import SignumError
from signum.common.files import UNFINISHED, sync_folder


class Movie:
    """An MP4 file; its size is the first frame's, made even. It appears when it is closed.

    Args:
        path: of the file.
        rate: frames a second when it is played.
        grey: whether it is made without colour; all frames are then uint8 (H, W).
    """

    def __init__(self, path: Path, rate: float = 10.0, grey: bool = False) -> None:
        self.path, self.rate, self.grey = path, rate, grey
        self.count = 0
        self._writer: cv2.VideoWriter | None = None
        self._size = (0, 0)
        # FFmpeg takes a relative name with a colon for a network address.
        self._half = path.with_name(f"{UNFINISHED}{path.name}").absolute()
        path.unlink(missing_ok=True)

    def write(self, frame: Image) -> None:
        """Append a frame, uint8 (H, W) or (H, W, 3) blue, green, red.

        Raises:
            SignumError: if the film cannot be begun.
        """
        if self._writer is None:
            self._size = frame.shape[1] // 2 * 2, frame.shape[0] // 2 * 2
            code = cv2.VideoWriter.fourcc(*"mp4v")
            self._writer = cv2.VideoWriter(str(self._half), code, self.rate, self._size, isColor=not self.grey)
            if not self._writer.isOpened():
                raise SignumError(f"{self.path}: cannot be begun: the disk is full, its folder cannot be written, or "
                                  "this OpenCV writes no MP4")
        shown = frame if frame.ndim == 3 or self.grey else cv2.cvtColor(frame, cv2.COLOR_GRAY2BGR)
        self._writer.write(np.ascontiguousarray(shown[:self._size[1], :self._size[0]]))
        self.count += 1

    def close(self) -> None:
        """Finish the file.

        Raises:
            SignumError: if it does not hold all frames, as on a full disk; it is then removed.
        """
        if self._writer is None:
            return
        self._writer.release()
        self._writer = None
        film = cv2.VideoCapture(str(self._half))
        held = int(film.get(cv2.CAP_PROP_FRAME_COUNT))
        film.release()
        if held != self.count:
            self._half.unlink(missing_ok=True)
            raise SignumError(f"{self.path}: holds {max(held, 0)} of {self.count} frames: the disk is full or was "
                              "taken away; mend that, or choose another --out")
        with self._half.open("rb+") as file:
            os.fsync(file.fileno())
        self._half.replace(self.path)
        sync_folder(self.path.parent)
