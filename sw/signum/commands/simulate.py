# SPDX-License-Identifier: Apache-2.0
"""`signum simulate`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from signum.applications.follow.pilot import Where
from signum.applications.follow.simulate import Chase, simulate_chase
from signum.applications.hold.simulate import Scenario, simulate_hold
from signum.commands.app import command
from signum.commands.options import OUTPUT, SIMULATION, BoardName, OutOption, SeedOption
from signum.commands.outputs import Outputs
from signum.commands.reel import Reel, write_calibration
from signum.commands.session import board_of
from signum.common.console import out, progress
from signum.common.errors import SignumError
from signum.measure.measurer import Measurer
from signum.sources.simulated import SurveyPlan
from signum.world.camera import Pinhole
from signum.world.scenes import Still, drift, survey, truth_of
from signum.world.water import WATERS

SIGMA = 2.0
"""Width of the LoG's Gaussian with which a simulated vehicle is steered, pixels."""


class Kind(StrEnum):
    """What is rendered."""

    survey = "survey"
    drift = "drift"
    hold = "hold"
    midwater = "midwater"
    terrain = "terrain"


class WaterName(StrEnum):
    """The waters of `sources.simulated.WATERS`, for the choice on the command line."""

    clear = "clear"
    coastal = "coastal"
    paper = "paper"


@dataclass(frozen=True)
class SceneOptions:
    """What the simulated world is, and the length and the rate of the run."""

    seconds: Annotated[float, typer.Option("--seconds", rich_help_panel=SIMULATION, min=0.2,
                                           help="Length of the run.")] = 20.0
    rate: Annotated[float, typer.Option("--rate", rich_help_panel=SIMULATION, min=0.5, max=60.0,
                                        help="Frames per second.")] = 10.0
    height: Annotated[float, typer.Option("--height", rich_help_panel=SIMULATION, min=0.5, max=8.0,
                                          help="Over the floor, metres; not midwater and terrain.")] = 2.0
    water: Annotated[WaterName, typer.Option("--water", rich_help_panel=SIMULATION,
                                             help="How the water dims and blurs the view.")] = WaterName.coastal
    stereo: Annotated[bool, typer.Option("--stereo", rich_help_panel=SIMULATION,
                                         help="A right camera too (not hold and terrain).")] = False
    seed: SeedOption = 0


SCENE_DEFAULTS = SceneOptions()


@command()
def simulate(
    kind: Annotated[Kind, typer.Argument(help="survey: columns back and forth; drift: carried by the current; hold: on "
                                         "station in a current; midwater, terrain: a followed fish.")] = Kind.survey,
    output: OutOption = Path("out/simulate"),
    pictures: Annotated[bool, typer.Option("--pictures", rich_help_panel=OUTPUT,
                                           help="Folders of PNG instead of video.")] = False,
    scene: SceneOptions = SCENE_DEFAULTS,
) -> None:
    """Render the simulated world to try the other commands on: `left.mp4` (and `right.mp4`), `truth.csv`, and the
    cameras as `calibration.yaml`.

    Example: `signum simulate survey --seconds 60 --rate 2 --pictures --out out/sea`
    """
    if scene.stereo and kind in (Kind.hold, Kind.terrain):
        raise SignumError(f"{kind} is seen by one camera: leave --stereo out, or take survey, drift or midwater")
    camera = Pinhole()
    with closing(Outputs(output, "simulate")) as outputs:
        write_calibration(outputs.file("calibration.yaml"), camera)
        out.print(f"seed {scene.seed}")
        reel: Reel | None = None
        try:
            with progress("rendering", math.ceil(scene.seconds * scene.rate)) as tell:
                for still in _stills(kind, camera, scene):
                    reel = reel or Reel(outputs.file, scene.rate, pictures, list(still.truth))
                    reel.add(still)
                    tell("")
        finally:
            if reel is not None:
                reel.close()
                out.print(f"{output}: {reel.count} frames, {' and '.join(reel.names)}, truth.csv, calibration.yaml")


def _stills(kind: Kind, camera: Pinhole, scene: SceneOptions) -> Iterator[Still]:
    """The moments of the run, each with its truth."""
    water, seed = WATERS[scene.water], scene.seed
    if kind is Kind.survey:
        yield from survey(SurveyPlan().place, scene.seconds, scene.rate, scene.height, scene.stereo, water, seed,
                          camera)
        return
    if kind is Kind.drift:
        yield from drift(scene.seconds, scene.rate, scene.height, scene.stereo, water, seed, camera)
        return
    with board_of(BoardName.golden) as board:  # measures what the camera sees, which steers the vehicle
        def measurer(size: tuple[int, int]) -> Measurer:
            return Measurer(board, size, SIGMA)

        if kind is Kind.hold:
            scenario = Scenario(scene.seconds, scene.rate, scene.height, water=water, seed=seed)
            for m in simulate_hold(measurer, scenario, camera):
                ahead, aside, _, heading = m.truth
                yield Still(m.time, (m.frame,), truth_of(np.array([ahead, aside, 0.0]), (*m.level, heading),
                                                         m.range_m))
            return
        chase = Chase(Where(kind), scene.seconds, scene.rate, water=water, seed=seed)
        for g in simulate_chase(measurer, chase, camera):
            named = {"north_m": g.position[0], "east_m": g.position[1], "depth_m": g.position[2],
                     "pan_deg": math.degrees(g.head[0]), "tilt_deg": math.degrees(g.head[1]),
                     "fish_x_px": g.truth[0], "fish_y_px": g.truth[1], "fish_range_m": g.range_m}
            yield Still(g.time, g.frames if scene.stereo else g.frames[:1], named)
