# SPDX-License-Identifier: Apache-2.0
"""What `signum simulate` writes: frames as video or pictures, the truth, the cameras' calibration."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from signum.common.files import write_picture, write_text
from signum.geometry.calibration import Lens, Rig, calibration_text
from signum.report.movie import Movie
from signum.tables.table import Table
from signum.world.camera import BASELINE_M, Pinhole
from signum.world.scenes import Still


class Reel:
    """Writes frames as video or pictures, and `truth.csv`; complete after every frame but for a video, whose end
    `close` writes."""

    def __init__(self, file: Callable[[str], Path], rate: float, pictures: bool, columns: list[str]) -> None:
        self.rate, self.pictures = rate, pictures
        self._file = file
        self.names: list[str] = []
        self.count = 0
        self._films: list[Movie] = []
        self._columns = columns
        self._table = Table(file("truth.csv"), ["frame", "time_s", *columns])

    def add(self, still: Still) -> None:
        """Write the frames and the truth of a moment."""
        for side, frame in zip(("left", "right"), still.frames, strict=False):
            name = side if self.pictures else f"{side}.mp4"
            if name not in self.names:
                self.names.append(name)
                if not self.pictures:
                    self._films.append(Movie(self._file(name), self.rate))
            if self.pictures:
                path = self._file(f"{side}/{self.count:05d}.png")
                path.parent.mkdir(exist_ok=True)
                write_picture(path, frame)
            else:
                self._films[self.names.index(name)].write(frame)
        frame_name = f"{self.count:05d}" if self.pictures else str(self.count)
        self._table.write([frame_name, f"{still.time:.3f}",
                           *("" if math.isnan(still.truth[c]) else f"{still.truth[c]:.5f}" for c in self._columns)])
        self.count += 1

    def close(self) -> None:
        """Finish the files."""
        self._table.close()
        for film in self._films:
            film.close()


def write_calibration(path: Path, camera: Pinhole) -> None:
    """The simulated cameras in OpenCV's YAML: one alone, and the stereo pair."""
    k = np.array([[camera.focal, 0, camera.centre[0]], [0, camera.focal, camera.centre[1]], [0, 0, 1]])
    lens = Lens(k, np.zeros(5), camera.size)
    write_text(path, calibration_text(lens, Rig(lens, lens, np.eye(3), np.array([-BASELINE_M, 0.0, 0.0]), str(path))))
