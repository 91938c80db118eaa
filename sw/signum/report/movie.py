# SPDX-License-Identifier: Apache-2.0
"""MP4 files written frame by frame, complete once they are closed: H.264, which browsers play.

The encoder may say nothing when the disk is full, so a closed film is counted before it takes its name.
"""

from __future__ import annotations

import os
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np

from signum.common.arrays import Image
from signum.common.errors import SignumError
from signum.common.files import UNFINISHED, sync_folder

CODEC, PIXELS = "libx264", "yuv420p"
"""What every browser plays."""
ENCODING = {"preset": "superfast", "crf": "18", "coder": "vlc"}
"""Encoder's speed, its quality, hardly a difference to be seen, and its entropy coding, CAVLC: the pictures are those
of CABAC, in half of the time and 5 % more bytes."""


class Movie:
    """An MP4 file; its size is the first frame's, made even. It appears when it is closed.

    Args:
        path: of the file.
        rate: frames a second when it is played.
    """

    def __init__(self, path: Path, rate: float = 10.0) -> None:
        self.path, self.rate = path, rate
        self.count = 0
        self._film: Any = None
        self._stream: Any = None
        self._size = (0, 0)
        # FFmpeg takes a relative name with a colon for a network address.
        self._half = path.with_name(f"{UNFINISHED}{path.name}").absolute()
        path.unlink(missing_ok=True)

    def write(self, frame: Image) -> None:
        """Append a frame, uint8 (H, W) or (H, W, 3) blue, green, red.

        Raises:
            SignumError: if the film cannot be written.
        """
        try:
            if self._film is None:
                self._begin(frame)
            width, height = self._size
            shown = np.ascontiguousarray(frame[:height, :width])
            picture = av.VideoFrame.from_ndarray(shown, format="gray" if shown.ndim == 2 else "bgr24")
            picture.pts = self.count
            self._film.mux(self._stream.encode(picture.reformat(format=PIXELS)))
        except OSError as error:
            raise SignumError(self._trouble(error.strerror or str(error))) from error
        self.count += 1

    def _begin(self, frame: Image) -> None:
        """Open the file for frames of the size of the first."""
        self._size = max(frame.shape[1] // 2 * 2, 2), max(frame.shape[0] // 2 * 2, 2)
        self._film = av.open(str(self._half), "w", format="mp4")
        rate = Fraction(self.rate).limit_denominator(1001)
        self._stream = self._film.add_stream(CODEC, rate=rate, options=ENCODING)
        self._stream.width, self._stream.height = self._size
        self._stream.pix_fmt, self._stream.thread_count = PIXELS, 1
        self._stream.codec_context.time_base = 1 / rate

    def close(self) -> None:
        """Finish the file.

        Raises:
            SignumError: if it does not hold all frames, as on a full disk; it is then removed.
        """
        if self._film is None:
            return
        film, self._film = self._film, None
        held, why = 0, ""
        try:
            film.mux(self._stream.encode())
            film.close()
            with av.open(str(self._half)) as done:
                held = done.streams.video[0].frames
        except (OSError, IndexError) as error:
            why = str(error)
        if held != self.count:
            self._half.unlink(missing_ok=True)
            raise SignumError(self._trouble(why or f"it holds {held} of {self.count} frames"))
        with self._half.open("rb+") as file:
            os.fsync(file.fileno())
        self._half.replace(self.path)
        sync_folder(self.path.parent)

    def _trouble(self, why: str) -> str:
        return (f"{self.path}: the film cannot be written ({why}): the disk is full, or its folder cannot be written; "
                "mend that, or choose another --out")
