# SPDX-License-Identifier: Apache-2.0
"""The Verilated `tiny` board when its work is interrupted: resets at any clock, cameras that stop in mid-frame."""

from __future__ import annotations

import random
import warnings
from collections.abc import Iterator

import numpy as np
import pytest

from golden import log
from golden.params import TINY
from sim.board.device import Device, frame_beats
from sim.board.driver import UnfinishedFrame
from sim.board.tests.resets import FIRST_ROW, WORK, sweep

SIZE = 33, 25


@pytest.fixture(scope="module")
def tiny() -> Iterator[Device]:
    with Device("tiny") as device:
        yield device


def test_one_clock_resets(tiny: Device) -> None:
    """A sample of all clocks, and every clock around the start of the first output row (see `resets`)."""
    others = random.Random(15).sample(range(WORK), 60)
    moments = [*range(FIRST_ROW - 4, FIRST_ROW + 20), *others]
    assert sweep(tiny, moments) == len(moments)


@pytest.mark.parametrize("sent", [1, 10, 33 * 9 + 5, 33 * 24])
def test_unplugged_camera(tiny: Device, sent: int) -> None:
    """A frame that never ends does not stop a filter change: it is dropped, with a warning, and the next is captured.

    The slots that hold frames keep them, and the request that waited for the frame is served by the next one.
    """
    rng = np.random.default_rng(sent)
    frames = [rng.integers(0, 256, SIZE[::-1], dtype=np.uint8) for _ in range(3)]
    tiny.reset()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tiny.set_filter(*log.kernels(1.5, TINY.radius), SIZE)
    tiny.capture({0: 0, 1: 1}, {0: frames[0], 1: frames[1]})
    drops = tiny.counters()["drops[0]"]
    tiny.arm(2)
    tiny.play_beats(frame_beats(frames[1])[:sent])
    tiny.finish_playing()
    tiny.tick(2000)
    assert tiny.read("filter.active") == 1
    with pytest.warns(UnfinishedFrame, match="a frame of camera 0 did not end"):
        tiny.set_filter(*log.kernels(2.0, TINY.radius))
    assert tiny.counters()["drops[0]"] == drops + 1
    assert tiny.read("slot_status.valid") == 0b11 and tiny.read("slot_status.armed") == 1
    tiny.play_beats(frame_beats(frames[1])[sent:])  # the camera is plugged in again: pixels without a start of frame
    tiny.play(frames[2])
    tiny.finish_playing()
    tiny.wait_captured(0)
    assert tiny.counters()["drops[0]"] == drops + 1
    for slot, (frame, sigma) in enumerate(zip(frames, (1.5, 1.5, 2.0), strict=True)):
        assert np.array_equal(tiny.plane(slot), log.sign(frame, sigma, TINY.radius)), slot


def test_abort_without_a_frame(tiny: Device) -> None:
    """An abort between frames changes nothing."""
    tiny.reset()
    tiny.set_filter(*log.kernels(1.5, TINY.radius), SIZE)
    frame = np.random.default_rng(1).integers(0, 256, SIZE[::-1], dtype=np.uint8)
    tiny.arm(3, 1)
    tiny.write("filter", abort_0=1, abort_1=1)
    tiny.tick(16)  # a command reaches the front ends some clocks after its write is answered
    tiny.play(frame, 1)
    tiny.finish_playing()
    tiny.wait_captured(1)
    assert np.array_equal(tiny.plane(3), log.sign(frame, 1.5, TINY.radius))
    assert tiny.counters()["drops[0]"] == tiny.counters()["drops[1]"] == 0
