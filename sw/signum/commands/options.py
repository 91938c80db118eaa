# SPDX-License-Identifier: Apache-2.0
"""The options that several commands share, each defined once, and the names of the groups in `--help`."""

from __future__ import annotations

from collections.abc import Mapping
from contextvars import ContextVar
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from golden.params import MAX_SIGMA, MIN_SIGMA

SOURCE, BOARD, OUTPUT, SIMULATION, AUTOPILOT = "Source", "Board", "Output", "Simulation", "Autopilot"
"""Groups of options that several commands have."""
GIVEN: ContextVar[str] = ContextVar("options", default="")
"""The options of the command at work as its command line takes them, with the defaults of those that were not given."""


def tell_defaults(options: Mapping[str, tuple[object, object]]) -> None:
    """Add to GIVEN the options that were not given, with what is taken for them: by name (given, taken)."""
    told = " ".join(f"--{name} {taken}" for name, (given, taken) in options.items() if given is None)
    GIVEN.set(f"{GIVEN.get()} {told}".strip())


class BoardName(StrEnum):
    """The boards of `boards.BOARDS`, for the choice on the command line."""

    golden = "golden"
    verilated = "verilated"


def folder(text: str | Path) -> Path:
    """A folder as the command line names it.

    Raises:
        typer.BadParameter: if the name is empty, as from a variable that is not set; it would be the current folder.
    """
    if not str(text):
        raise typer.BadParameter("is empty: name a folder, . for the current one")
    return Path(text)


SourceArgument = Annotated[str, typer.Argument(
    help="Video, folder of pictures, ROS bag, .npy array, camera number, stream (udp://:5600, rtsp://, http://) or "
    "world:NAME=VALUE.", show_default=False)]
CalibrationOption = Annotated[Path | None, typer.Option(
    "--calibration", rich_help_panel=SOURCE, help="Calibration of the camera, whose lens distortion is taken out of "
    "every frame: a file of `signum calibrate`, OpenCV, ROS (camera_info) or Kalibr (FILE#cam1 for another camera), or "
    "CameraInfo in a bag: BAG or BAG#/TOPIC.")]
FocalOption = Annotated[float | None, typer.Option(
    "--focal", rich_help_panel=SOURCE, min=1.0, show_default="of --calibration, or 1.04 widths",
    help="Focal length in pixels of the source's frames.")]
PairOption = Annotated[Path | None, typer.Option(
    "--calibration", rich_help_panel=SOURCE, show_default=False, help="Calibration of the stereo pair: a file of "
    "`signum calibrate`, OpenCV (K1 D1 K2 D2 R T) or Kalibr, two files of ROS (LEFT.yaml,RIGHT.yaml), or CameraInfo in "
    "a bag: BAG or BAG#/LEFT,/RIGHT.")]
OutOption = Annotated[Path, typer.Option("--out", rich_help_panel=OUTPUT, parser=folder, metavar="PATH",
                                         help="Folder for the files that are written; made if missing.")]
BoardOption = Annotated[BoardName, typer.Option(
    "--board", rich_help_panel=BOARD, help="Golden model, or RTL under Verilator: identical bits.")]
SigmaOption = Annotated[float, typer.Option(
    "--sigma", rich_help_panel=BOARD, min=MIN_SIGMA, max=MAX_SIGMA,
    help="Width of the LoG's Gaussian, pixels of the board's picture.")]
WindowOption = Annotated[int, typer.Option(
    "--window", rich_help_panel=BOARD, min=8, max=128,
    help="Side of the correlation windows, pixels of the board's picture.")]
DenseOption = Annotated[bool, typer.Option(
    "--dense", rich_help_panel=BOARD, help="Measure around every pixel, on a board with the dense engine.")]
SecondsOption = Annotated[float | None, typer.Option(
    "--seconds", min=1.0, show_default="60; a source's whole length", help="Length of the run.")]
SeedOption = Annotated[int, typer.Option("--seed", rich_help_panel=SIMULATION, min=0,
                                         help="Seed of all that is random in the simulated world.")]
MavlinkOption = Annotated[str | None, typer.Option(
    "--mavlink", rich_help_panel=AUTOPILOT, show_default=False, help="Send what is measured, in real time, over "
    "MAVLink to udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT or serial:DEVICE:BAUD.")]
MegapixelsOption = Annotated[float, typer.Option(
    "--megapixels", rich_help_panel=SOURCE, min=0.001, max=1e6,
    help="Largest picture that is decoded, millions of pixels; its size is checked before.")]


@dataclass(frozen=True)
class BoardOptions:
    """Which board measures, and with what filter and window."""

    board: BoardOption = BoardName.golden
    sigma: SigmaOption = 2.0
    window: WindowOption = 64
