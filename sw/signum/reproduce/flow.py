# SPDX-License-Identifier: Apache-2.0
"""Figure 6: optical flow, and its error on known shifts, clean and under figure 8's degradation."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.measure.flow import FlowField, measure_flow
from signum.measure.measurer import Measurer
from signum.report.draw import draw_flow
from signum.report.page import Bar, Section, figure, paragraph, row
from signum.reproduce import OpenBoard, Progress
from signum.world.camera import Pinhole
from signum.world.degrade import degrade
from signum.world.seafloor import PHOTOS, Seafloor, photograph
from signum.world.water import COASTAL
from signum.world.world import World

CAMERA = Pinhole()
SHIFT_SIGMA = 1.5
"""Width of the LoG's Gaussian on shifted photographs, pixels."""
SHIFTS = 10
"""Shifts of each photograph."""
MOST_PX = 8.0
"""Largest shift along an axis, pixels."""


def make(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
    """A field over relief in turbid water; then errors on shifted photographs."""
    photos, shifts = (PHOTOS[:1], 2) if quick else (PHOTOS, SHIFTS)
    rng = np.random.default_rng([seed, 11])
    squares: dict[bool, list[Floats]] = {False: [], True: []}
    valid: dict[bool, list[float]] = {False: [], True: []}
    with open_board() as board, progress("flow", 1 + 2 * len(photos) * shifts) as tell:
        before, after, field = _field(Measurer(board, CAMERA.size, 2.0), seed)
        tell("figure 6")
        for name in photos:
            for k in range(shifts):
                shift = rng.uniform(-MOST_PX, MOST_PX, 2)
                for degraded in (False, True):
                    pair = [shifted(photograph(name).astype(np.float32), at) for at in (np.zeros(2), shift)]
                    if degraded:
                        pair = [degrade(p, seed + 2 * k + i) for i, p in enumerate(pair)]
                    measurer = Measurer(board, CAMERA.size, SHIFT_SIGMA)
                    found = measure_flow(measurer, measurer.view(pair[0]), measurer.view(pair[1]), support=1)
                    miss = (found.dx - shift[0]) ** 2 + (found.dy - shift[1]) ** 2
                    squares[degraded].append(miss[found.valid])
                    valid[degraded].append(float(found.valid.mean()))
                    tell(name)
    rms = {d: float(np.sqrt(np.concatenate(v).mean())) for d, v in squares.items()}
    bars = (Bar("RMS on clean synthetic shifts, px", rms[False], "<=", 0.1),
            Bar("RMS under figure 8's degradation, px", rms[True], "<=", 0.25))
    body = paragraph("A camera flies over relief in turbid water with a lamp and drifting snow, climbing and turning. "
                     "Every arrow is one validated measurement; a cross is one that was refused.")
    body += row([figure(before, "time t"), figure(after, "time t + dt"),
                 figure(draw_flow(before, field, 2.0), "flow, arrows twice as long")])
    body += paragraph(f"Photographs ({', '.join(photos)}) shifted by up to {MOST_PX:g} px, {shifts} times each: "
                      f"{np.mean(valid[False]):.0%} of the windows are valid on clean pictures, "
                      f"{np.mean(valid[True]):.0%} on degraded ones.")
    return [Section("Figure 6: optical flow", body, bars)]


def shifted(photo: NDArray[np.float32], shift: Floats) -> Image:
    """The middle of a photograph (grey levels) moved by `shift` pixels: uint8 of the camera's size."""
    matrix = np.array([[1, 0, shift[0] - 60], [0, 1, shift[1] - 60]])
    return np.asarray(np.clip(cv2.warpAffine(photo, matrix, CAMERA.size, flags=cv2.INTER_CUBIC), 0, 255), np.uint8)


def _field(measurer: Measurer, seed: int) -> tuple[Image, Image, FlowField]:
    world = World(Seafloor(extent=6.0, relief=0.12, seed=seed), COASTAL, seed=seed)
    poses = (np.array([0.0, 0.0, -2.0]), (0.0, 0.0, 0.0)), (np.array([0.035, 0.02, -2.03]), (0.0, 0.0, 0.03))
    frames = []
    for position, attitude in poses:
        frames.append(world.look(CAMERA, Sight(position, rotation(*attitude) @ LOOK_DOWN)).frame)
        world.step(0.2)
    field = measure_flow(measurer, measurer.view(frames[0]), measurer.view(frames[1]), (48, 48), 24, support=1)
    return frames[0], frames[1], field
