# SPDX-License-Identifier: Apache-2.0
"""Makes the docs' pictures from the project's own code: `python docs/tools/pictures.py`."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np

from golden.log import sign
from golden.params import DENSE
from signum.boards import open_board
from signum.common.arrays import Image
from signum.common.files import write_picture
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.measure.dense_flow import measure_dense_flow
from signum.measure.measurer import Measurer
from signum.measure.moving import segment_moving
from signum.report.outlines import draw_outlines, mask_picture
from signum.report.wheel import draw_wheel_flow
from signum.world.camera import Pinhole
from signum.world.degrade import degrade
from signum.world.fish import Fish
from signum.world.seafloor import Seafloor, photograph
from signum.world.water import COASTAL
from signum.world.world import World

ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / "docs" / "img"
SIGMA, GAP = 1.5, 8
FISH = ((0.15, -0.35), (0.1, 0.4)), ((-0.2, 0.4), (0.15, -0.25))
"""Of two fish: place and velocity, metres and m/s north and east."""


def signs() -> Image:
    """A photograph and the same in bad water, side by side, over their signs; uint8 (488, 648)."""
    clear = np.ascontiguousarray(photograph("gravel")[120:360, 100:420])
    columns = [np.vstack([view, np.full((GAP, view.shape[1]), 255, np.uint8), sign(view, SIGMA) * np.uint8(255)])
               for view in (clear, degrade(clear))]
    return np.hstack([columns[0], np.full((columns[0].shape[0], GAP), 255, np.uint8), columns[1]])


def moving() -> Image:
    """Two simulated fish over a floor, seen by a camera that moves and turns: the field with their outlines, and the
    mask; uint8 (480, 1288, 3)."""
    camera = Pinhole((640, 480), 600.0)
    fish = []
    for seed, (place, way) in enumerate(FISH):
        at, ahead = np.array([*place, -1.4]), np.array([*way, 0.0])
        fish.append(Fish(at, 0.45, float(np.hypot(*way)), at + 9 * ahead, (0.0, 0.0, 0.0), stops=0.0, seed=2 * seed))
        fish[-1].velocity, fish[-1].facing = ahead, ahead / np.linalg.norm(ahead)
    world = World(Seafloor(extent=6.0, relief=0.05, texel=0.004), COASTAL, fish, seed=3)
    frames = []
    for k in range(2):
        sight = Sight(np.array([0.02 * k, 0.01 * k, -3.0]), rotation(0.0, 0.0, 0.015 * k) @ LOOK_DOWN)
        frames.append(world.look(camera, sight).frame)
        world.step(0.1)
    with open_board("golden", DENSE) as board:
        measurer = Measurer(board, camera.size, SIGMA)
        views = measurer.pair(*frames)
        field = measure_dense_flow(measurer, *views, step=4)
        found = segment_moving(measurer, *views, field)
    mask = np.repeat(mask_picture(found)[..., None], 3, -1)
    gap = np.full((mask.shape[0], GAP, 3), 255, np.uint8)
    return np.hstack([draw_outlines(draw_wheel_flow(frames[0], field), found), gap, mask])


def main() -> None:
    """Write the pictures."""
    write_picture(IMAGES / "signs.png", signs(), 9)
    write_picture(IMAGES / "dense-moving.jpg", moving())
    spec = importlib.util.spec_from_file_location("surface", ROOT / "examples" / "surface.py")
    assert spec is not None and spec.loader is not None
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    example.main(str(IMAGES / "surface.png"))


if __name__ == "__main__":
    main()
