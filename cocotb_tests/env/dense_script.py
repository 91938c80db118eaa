# SPDX-License-Identifier: Apache-2.0
"""What scenarios of the board with the dense engine share: captures of pairs, passes held against the frame level, the
run against the cycle model."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

import cocotb
import numpy as np

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.dense_host import DenseHost
from cocotb_tests.env.host import Script
from golden.correlate import Plane
from golden.cycle.board import RESET_START
from golden.cycle.dense_board import DenseBoardModel
from golden.dense import DensePass
from golden.dense_job import DenseJob, DenseResult, run_dense
from golden.log import Image, sign
from golden.params import TINY_DENSE
from golden.traffic.video import texture
from sim.board.dense import map_shape, unpack_map
from sim.registers.map import dense_fields, fields

SIGMA = 1.5
SIZE = 20, 18
OTHER = 21, 19
"""Another size, for changes between frames."""
FIELDS = tuple(DenseResult.__dataclass_fields__)

Planes = dict[int, Plane]


def random_job(rng: random.Random, slots: int = 2) -> DenseJob:
    """A good job of any kind."""
    one = DensePass(rng.choice(TINY_DENSE.dense_windows), rng.randint(1, TINY_DENSE.dense_offsets),
                    rng.randint(-20, 6), rng.randint(-3, 3))
    return DenseJob(rng.randrange(slots), rng.randrange(slots), one, (rng.choice((1, 1, 2, 5)), rng.choice((1, 1, 3))),
                    rng.randint(4, 40), rng.randint(0, 4), rng.random() < 0.5)


def pair_of_frames(h: DenseHost) -> list[Image]:
    """Two frames of one scene, the second one moved."""
    image = texture(h.rng, h.size[0] + 4, h.size[1])
    return [np.ascontiguousarray(image[:, 4 * camera:4 * camera + h.size[0]]) for camera in (0, 1)]


def signs_of(frame: Image) -> Plane:
    """The plane that a capture of the frame gives."""
    return sign(frame, SIGMA, TINY_DENSE.radius)


def capture_pair(h: DenseHost, planes: Planes) -> Script:
    """Frames of one scene from both cameras at the same time into slots 0 and 1, the second one moved."""
    for camera, frame in enumerate(pair_of_frames(h)):
        planes[camera] = signs_of(frame)
        yield from h.arm(camera, camera)
        h.show(camera, frame)
    yield from h.captured()


def check_map(h: DenseHost, job: DenseJob, planes: Planes, size: tuple[int, int], status: int) -> None:
    """Status and map of a pass against the frame level."""
    wanted, result = run_dense(job, planes, TINY_DENSE, size)
    words = h.take_map()
    assert status == wanted, job
    if result is None:
        assert not words
        return
    shape = map_shape(size, job.step)
    assert len(words) == shape[0] * shape[1]
    found = unpack_map(np.array(words, np.uint64), shape)
    for name in FIELDS:
        assert np.array_equal(getattr(found, name), getattr(result, name)), f"{name} of {job}"


def run_pass(h: DenseHost, job: DenseJob, planes: Planes) -> Script:
    """A pass, held against the frame level."""
    yield from h.load(job)
    yield from h.go()
    check_map(h, job, planes, h.size, (yield from h.finished()))


async def run_scenario(dut: Any, script: Callable[[DenseHost], Script], video: str = "none", sink: str = "none",
                       bus: str = "none") -> DenseHost:
    """Play a scenario on board and model; the host afterwards."""
    host = DenseHost(TINY_DENSE, random.Random(cocotb.RANDOM_SEED), video, sink, bus)
    model = DenseBoardModel(TINY_DENSE, fields(), dense_fields())
    clocks = await check_cycles(dut, model, host.play(script(host)), reset_clocks=RESET_START)
    assert clocks > 2000 and host.master.finished > 60
    return host
