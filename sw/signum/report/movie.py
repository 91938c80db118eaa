# SPDX-License-Identifier: Apache-2.0
"""MP4 files written frame by frame, complete once they are closed."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from signum.common.arrays import Image


class Movie:
    """An MP4 file; its size is the first frame's, made even. It appears when it is closed.

    Args:
        path: of the file.
        rate: frames a second when it is played.
    """

    def __init__(self, path: Path, rate: float = 10.0) -> None:
        self.path, self.rate = path, rate
        self._writer: cv2.VideoWriter | None = None
        self._size = (0, 0)
        self._half = path.with_name(f".part-{path.name}")
        path.unlink(missing_ok=True)

    def write(self, frame: Image) -> None:
        """Append a frame, uint8 (H, W) or (H, W, 3) blue, green, red."""
        if self._writer is None:
            self._size = frame.shape[1] // 2 * 2, frame.shape[0] // 2 * 2
            self._writer = cv2.VideoWriter(str(self._half), cv2.VideoWriter.fourcc(*"mp4v"), self.rate, self._size)
        colour = frame if frame.ndim == 3 else cv2.cvtColor(frame, cv2.COLOR_GRAY2BGR)
        self._writer.write(np.ascontiguousarray(colour[:self._size[1], :self._size[0]]))

    def close(self) -> None:
        """Finish the file."""
        if self._writer is not None:
            self._writer.release()
            self._writer = None
            self._half.replace(self.path)
