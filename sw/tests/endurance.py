# SPDX-License-Identifier: Apache-2.0
"""Long runs: memory and time of `mosaic`, `track` and `hold` over thousands of frames; `make endurance`.

    python -m tests.endurance [--mosaic 2000] [--long 10000]

The frames are simulated while they are needed, small, and the same ones again and again for `track` and `hold`. Bounds:
memory of `track` and `hold` flat to 8 kB a frame, for the rows that the report needs; of `mosaic` to 120 kB a stored
frame, for its small copy, registrations and place; processor time a frame at the end at most 1.2 times that at the
beginning, which is of `mosaic` from frame 25 to 75: the mean, as once in a while all its frames are placed again.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

from signum.applications.hold.record import HoldRecord
from signum.applications.hold.watch import watch_station
from signum.applications.mosaic.survey import Survey
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Image
from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.measure.measurer import Measurer
from signum.measure.register import Registrar
from signum.measure.track import Tracker, TrackSettings
from signum.report.rows import track_row
from signum.tables.schemas import TRACK
from signum.tables.table import Table

SIZE, WINDOW, SIGMA = (160, 120), 32, 2.0
LEAST_FLAT = 1.2
BYTES_A_ROW, BYTES_A_STORED_FRAME = 8_000, 120_000


def memory() -> int:
    """Resident memory of this process, bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


def floor(height: int, width: int) -> Image:
    """A texture without repetition."""
    noise = np.random.default_rng(1).integers(0, 256, (height, width), dtype=np.uint8)
    return np.asarray(cv2.GaussianBlur(noise, (0, 0), 1.5), np.uint8) * 2


def swinging(count: int) -> Iterator[Frame]:
    """A camera that swings about a station, with noise."""
    texture, rng = floor(SIZE[1] + 40, SIZE[0] + 40), np.random.default_rng(2)
    for k in range(count):
        x, y = round(20 + 9 * np.sin(k / 17)), round(20 + 9 * np.cos(k / 23))
        seen = texture[y:y + SIZE[1], x:x + SIZE[0]] + rng.normal(0, 2, SIZE[::-1])
        yield Frame(str(k), np.asarray(np.clip(seen, 0, 255), np.uint8))


def columns(count: int) -> Iterator[Frame]:
    """Snapshots of a survey back and forth in lanes of ten, half a frame from one to the next."""
    along = 10
    step = SIZE[0] // 2, SIZE[1] // 2
    texture = floor(along * step[1] + SIZE[1], (count // along + 1) * step[0] + SIZE[0])
    for k in range(count):
        column, row = divmod(k, along)
        row = row if column % 2 == 0 else along - 1 - row
        x, y = column * step[0], row * step[1]
        yield Frame(str(k), np.ascontiguousarray(texture[y:y + SIZE[1], x:x + SIZE[0]]))


def main() -> int:
    """Measure all three; returns 0 if all bounds are kept."""
    parser = argparse.ArgumentParser(description="Memory and time over long runs.")
    parser.add_argument("--mosaic", type=int, default=2000, help="frames of the survey")
    parser.add_argument("--long", type=int, default=10_000, help="frames of track and hold")
    options = parser.parse_args()
    kept = True
    with tempfile.TemporaryDirectory() as name, GoldenBoard() as board:
        fit = Fit.to(SIZE, board.config, WINDOW)
        tracked = _steps(board, fit, options.long, Path(name))
        kept &= judge("track", tracked, BYTES_A_ROW, LEAST_FLAT)
        kept &= judge("hold", _holds(board, fit, options.long, Path(name)), BYTES_A_ROW, LEAST_FLAT)
        registrar = Registrar.on(lambda size, sigma: Measurer(board, size, sigma), fit, WINDOW, SIGMA)
        survey = Survey(registrar, Path(name) / "survey")
        taken = (survey.add(frame) for frame in columns(options.mosaic))
        kept &= judge("mosaic", taken, BYTES_A_STORED_FRAME, LEAST_FLAT, range(25, 75))
        begun = time.process_time()
        for _ in survey.finish():
            pass
        print(f"mosaic: the last look for edges took {1e3 * (time.process_time() - begun) / options.mosaic:.1f} ms a "
              f"frame; {len(survey.ledger.accepted)} edges in {len(survey.pieces)} component(s)")
        survey.leave()
    return 0 if kept else 1


def _steps(board: GoldenBoard, fit: Fit, count: int, folder: Path) -> Iterator[None]:
    tracker = Tracker(Measurer(board, fit.board, SIGMA), TrackSettings(window=WINDOW, features=8))
    table = Table(folder / "track.csv", TRACK)
    for frame in swinging(count):
        for point in tracker.step(frame.picture):
            table.write(track_row(frame, point, fit))
        yield
    table.close()


def _holds(board: GoldenBoard, fit: Fit, count: int, folder: Path) -> Iterator[None]:
    record = HoldRecord(folder, truth=False)
    measurer = Measurer(board, fit.board, SIGMA)
    for seen in watch_station(measurer, swinging(count), fit, 170.0, 2.0, 10.0, WINDOW):
        record.add(seen.name, seen.time, seen.reading, seen.picture, seen.features, WINDOW)
        yield
    record.close()


def judge(name: str, steps: Iterator[object], most_bytes: float, most_slower: float, begin: range | None = None
          ) -> bool:
    """Run and print memory and time a frame, in fifths after a first fifth for warming up; whether bounds are kept.

    With `begin` the time is the mean of these frames, and of the last fifth.
    """
    times, memories = [time.process_time()], [memory()]
    for _ in steps:
        times.append(time.process_time())
        memories.append(memory())
    frames = len(times) - 1
    fifth = max(1, frames // 5)
    spent = np.diff(times)
    first = spent[fifth:2 * fifth] if begin is None else spent[begin.start:begin.stop]
    early, late = (float((np.median if begin is None else np.mean)(part)) for part in (first, spent[-fifth:]))
    grown = (memories[-1] - memories[fifth]) / max(1, frames - fifth)
    good = grown <= most_bytes and late <= most_slower * early
    print(f"{name}: {frames} frames, {1e3 * early:.1f} ms a frame at the beginning, {1e3 * late:.1f} ms at the "
          f"end "
          f"({late / early:.2f}x), memory {memories[-1] / 1e6:.0f} MB, {grown / 1e3:+.2f} kB a frame"
          + ("" if good else "  MISSED"), flush=True)
    return good


if __name__ == "__main__":
    sys.exit(main())
