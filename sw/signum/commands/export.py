# SPDX-License-Identifier: Apache-2.0
"""`signum export`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from signum.applications.trajectory.path import Scale, Trajectory, read_trajectories
from signum.applications.trajectory.tum import write_tum
from signum.commands.app import command
from signum.commands.options import SOURCE
from signum.commands.outputs import Outputs, began
from signum.common.console import out
from signum.common.errors import SignumError, lacking
from signum.sources.open import open_lens

FORMATS = "Formats"


@command()
def export(
    folder: Annotated[Path, typer.Argument(help="The --out folder of signum hold, mosaic or navigate.",
                                           show_default=False)],
    tum: Annotated[bool, typer.Option("--tum/--no-tum", rich_help_panel=FORMATS, help="hold.tum, poses.tum, ...: text "
                                      "that evo and others read.")] = True,
    bag: Annotated[bool, typer.Option("--bag", rich_help_panel=FORMATS, help="hold_bag, poses_bag, ...: ROS 2 bags "
                                      "with Odometry, tf and CameraInfo; needs the extra ros.")] = False,
    calibration: Annotated[Path | None, typer.Option(
        "--calibration", rich_help_panel=SOURCE, help="Calibration of the camera, for CameraInfo.")] = None,
    mosaic: Annotated[Path | None, typer.Option(
        "--mosaic", rich_help_panel=SOURCE, help="For navigate.csv: the folder of the mosaic, whose mosaic.pgw gives "
        "metres.")] = None,
    pixel: Annotated[float | None, typer.Option(
        "--pixel", rich_help_panel=SOURCE, min=1e-6, max=100.0, show_default="what the run's files say",
        help="Metres that a pixel of the mosaic covers.")] = None,
    range_m: Annotated[float | None, typer.Option(
        "--range", rich_help_panel=SOURCE, min=0.01, show_default="no heights", help="Metres from the camera to the "
        "floor where a frame's scale is 1, for heights over a mosaic.")] = None,
    rate: Annotated[float | None, typer.Option(
        "--rate", rich_help_panel=SOURCE, min=0.01, max=1000.0, help="Frames per second, where frames have no times.")
                    ] = None,
) -> None:
    """Trajectories of a finished run for other programs: TUM text and ROS 2 bags, beside its tables.

    Example: `signum export out/hold --bag --calibration camera.yaml`
    """
    if not (tum or bag):
        raise SignumError("nothing to write: leave --no-tum out, or add --bag")
    if calibration is not None and not bag:
        raise SignumError("--calibration is for CameraInfo, which --bag writes")
    world = None if mosaic is None else mosaic / "mosaic.pgw" if mosaic.is_dir() else mosaic.with_suffix(".pgw")
    if world is not None and not world.exists():
        raise SignumError(f"{world}: no such file: make the mosaic with --range or --navigation, or give --pixel")
    lens = None if calibration is None else open_lens(calibration)
    found = read_trajectories(folder, Scale(pixel, range_m, rate, world, began(folder, "hold")))
    try:
        from signum.applications.trajectory.bag import write_bag
    except ModuleNotFoundError as error:
        if bag:
            raise lacking("ros", error) from error
    outputs = Outputs(folder, "export")
    try:
        for one in found:
            if tum:
                write_tum(path := outputs.file(f"{one.name}.tum"), one)
                out.print(f"{path}: {_said(one)}")
            if bag:
                path = folder / f"{one.name}_bag"
                for name in ("metadata.yaml", f"{path.name}.mcap"):
                    outputs.file(f"{path.name}/{name}")
                if path.is_dir():
                    path.rmdir()  # an earlier export's, emptied
                write_bag(path, one, lens)
                out.print(f"{path}: {_said(one)}")
    finally:
        outputs.close()


def _said(one: Trajectory) -> str:
    gone = f", {one.left_out} without a position left out" if one.left_out else ""
    return f"{len(one.times)} poses in `{one.world}` from {one.times[0]:.3f} to {one.times[-1]:.3f} s{gone}"
