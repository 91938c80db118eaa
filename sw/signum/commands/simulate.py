"""`signum simulate`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import typer

from signum.applications.follow.pilot import Where
from signum.applications.follow.simulate import Chase, simulate_chase
from signum.applications.hold.simulate import Scenario, simulate_hold
from signum.commands.common import BoardName, OutOption, app, board_of, guarded
from signum.common.arrays import Image
from signum.common.console import out, progress
from signum.common.errors import SignumError
from signum.measure.measurer import Measurer
from signum.sources.simulated import SurveyTrack
from signum.tables.table import Table
from signum.world.camera import BASELINE_M, Pinhole
from signum.world.scenes import Still, drift, survey, truth_of
from signum.world.water import WATERS


class Kind(StrEnum):
    """What is rendered."""

    survey = "survey"
    drift = "drift"
    hold = "hold"
    midwater = "midwater"
    terrain = "terrain"


class WaterName(StrEnum):
    """Of WATERS."""

    clear = "clear"
    coastal = "coastal"
    paper = "paper"


@app.command()
@guarded
def simulate(
    kind: Annotated[Kind, typer.Argument(help="survey: columns back and forth; drift: carried by the current; hold: on "
                                         "station in a current; midwater, terrain: a followed fish.")] = Kind.survey,
    output: OutOption = Path("out/simulate"),
    seconds: Annotated[float, typer.Option("--seconds", min=0.2, help="Length.")] = 20.0,
    rate: Annotated[float, typer.Option("--rate", min=0.5, max=60.0, help="Frames per second.")] = 10.0,
    height: Annotated[float, typer.Option("--height", min=0.5, max=8.0, help="Over the floor, metres; not midwater and "
                                          "terrain.")] = 2.0,
    water: Annotated[WaterName, typer.Option("--water", help="What is in the way of the light.")] = WaterName.coastal,
    stereo: Annotated[bool, typer.Option("--stereo", help="A right camera too (not hold and terrain).")] = False,
    pictures: Annotated[bool, typer.Option("--pictures", help="Folders of PNG instead of video.")] = False,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of everything.")] = 0,
) -> None:
    """Render the simulated world to try the other commands on: `left.mp4` (and `right.mp4`), `truth.csv`, and the
    cameras as `calibration.yaml`.

    Example: `signum simulate survey --seconds 60 --rate 2 --pictures --out out/sea`
    """
    if stereo and kind in (Kind.hold, Kind.terrain):
        raise SignumError(f"{kind} is seen by one camera: leave --stereo out, or take survey, drift or midwater")
    camera = Pinhole()
    output.mkdir(parents=True, exist_ok=True)
    write_calibration(output / "calibration.yaml", camera)
    out.print(f"seed {seed}")
    reel: Reel | None = None
    try:
        with progress("rendering", math.ceil(seconds * rate)) as tell:
            for still in _stills(kind, camera, seconds, rate, height, water, stereo, seed):
                reel = reel or Reel(output, rate, pictures, list(still.truth))
                reel.add(still)
                tell("")
    finally:
        if reel is not None:
            reel.close()
            out.print(f"{output}: {reel.count} frames, {' and '.join(reel.names)}, truth.csv, calibration.yaml")


class Reel:
    """Writes frames as video or pictures, and the truth; good after every frame but for the video's end, which `close`
    writes."""

    def __init__(self, folder: Path, rate: float, pictures: bool, columns: list[str]) -> None:
        self.folder, self.rate, self.pictures = folder, rate, pictures
        self.names: list[str] = []
        self.count = 0
        self._writers: list[cv2.VideoWriter] = []
        self._columns = columns
        self._table = Table(folder / "truth.csv", ["frame", "time_s", *columns])

    def add(self, still: Still) -> None:
        """Write a moment."""
        for side, frame in zip(("left", "right"), still.frames, strict=False):
            name = side if self.pictures else f"{side}.mp4"
            if name not in self.names:
                self.names.append(name)
                self._open(name, frame)
            if self.pictures:
                cv2.imwrite(str(self.folder / side / f"{self.count:05d}.png"), frame)
            else:
                self._writers[self.names.index(name)].write(frame)
        frame_name = f"{self.count:05d}" if self.pictures else str(self.count)
        self._table.write([frame_name, f"{still.time:.3f}",
                           *("" if math.isnan(still.truth[c]) else f"{still.truth[c]:.5f}" for c in self._columns)])
        self.count += 1

    def _open(self, name: str, frame: Image) -> None:
        if self.pictures:
            folder = self.folder / name
            folder.mkdir(exist_ok=True)
            for old in folder.glob("*.png"):  # of a longer run before
                old.unlink()
            return
        size = frame.shape[1], frame.shape[0]
        self._writers.append(cv2.VideoWriter(str(self.folder / name), cv2.VideoWriter.fourcc(*"mp4v"), self.rate, size,
                                             isColor=False))
        if not self._writers[-1].isOpened():
            raise SignumError(f"{self.folder / name}: this OpenCV writes no MP4; use --pictures")

    def close(self) -> None:
        """Finish the files."""
        self._table.close()
        for writer in self._writers:
            writer.release()


def write_calibration(path: Path, camera: Pinhole) -> None:
    """The simulated cameras in OpenCV's YAML: one alone, and the stereo pair."""
    k = np.array([[camera.focal, 0, camera.centre[0]], [0, camera.focal, camera.centre[1]], [0, 0, 1]])
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    storage.write("image_width", camera.size[0])
    storage.write("image_height", camera.size[1])
    for name, value in (("camera_matrix", k), ("distortion_coefficients", np.zeros((1, 5))), ("K1", k),
                        ("D1", np.zeros((1, 5))), ("K2", k), ("D2", np.zeros((1, 5))), ("R", np.eye(3)),
                        ("T", np.array([[-BASELINE_M], [0.0], [0.0]]))):
        storage.write(name, value)
    storage.release()


def _stills(kind: Kind, camera: Pinhole, seconds: float, rate: float, height: float, water: WaterName, stereo: bool,
            seed: int) -> Iterator[Still]:
    light = WATERS[water]
    if kind is Kind.survey:
        yield from survey(SurveyTrack().place, seconds, rate, height, stereo, light, seed, camera)
    elif kind is Kind.drift:
        yield from drift(seconds, rate, height, stereo, light, seed, camera)
    else:
        with board_of(BoardName.golden) as board:  # the vehicle of these is steered by what it sees
            def measurer(size: tuple[int, int]) -> Measurer:
                return Measurer(board, size, 2.0)

            if kind is Kind.hold:
                for m in simulate_hold(measurer, Scenario(seconds, rate, height, water=light, seed=seed), camera):
                    ahead, aside, _, heading = m.truth
                    yield Still(m.time, (m.frame,), truth_of(np.array([ahead, aside, 0.0]), (*m.level, heading),
                                                             m.range_m))
            else:
                for g in simulate_chase(measurer, Chase(Where(kind), seconds, rate, water=light, seed=seed), camera):
                    named = {"north_m": g.position[0], "east_m": g.position[1], "depth_m": g.position[2],
                             "pan_deg": math.degrees(g.head[0]), "tilt_deg": math.degrees(g.head[1]),
                             "fish_x_px": g.truth[0], "fish_y_px": g.truth[1], "fish_range_m": g.range_m}
                    yield Still(g.time, g.frames if stereo else g.frames[:1], named)
