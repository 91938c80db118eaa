# SPDX-License-Identifier: Apache-2.0
"""The checked build of the `tiny` board, from random power-up states, its bus driven channel by channel."""

from __future__ import annotations

import numpy as np
import pytest

from golden import log
from golden.correlate import Job, run
from golden.params import TINY
from sim.board.device import Device
from sim.board.structs import ACCESS_DTYPE
from sim.registers.map import address, fields
from sim.seeds import session_rng

STORED = "image_size", "job.tpl", "job.search", "job.offsets", "job.grid", "job.step"
SIZE = 33, 25


def _mask(register: str) -> int:
    return sum(f.mask for name, f in fields().items() if name.rpartition(".")[0] == register)


@pytest.mark.slow  # the first of them builds the board
@pytest.mark.parametrize("overlap", [1, 6])
def test_channels_in_their_own_time(overlap: int) -> None:
    """Addresses before data and the reverse, any strobes, stalled responses: every access is answered once, a stored
    register holds what its writes left, and a capture and a job afterwards are right; no assertion fails."""
    rng = session_rng(f"accesses {overlap}")
    with Device(TINY, checked=True, power_up=1 + rng.getrandbits(30)) as device:
        held = {register: device.read_word(address(register)) for register in STORED}
        accesses = np.zeros(601, ACCESS_DTYPE)
        accesses[-1] = (True, address("irq_enable"), 0, 15, *(0, 0, 0), 0, 0)  # which the driver goes by
        expected: dict[int, int] = {}
        for k in range(len(accesses) - 1):
            register, data, strobes = rng.choice(STORED), rng.getrandbits(32), rng.choice((15, rng.getrandbits(4)))
            write = rng.random() < 0.6
            waits = [rng.choice((0, 0, 1, 2, 3, rng.randrange(60))) for _ in range(3)]
            accesses[k] = (write, address(register), data, strobes, *waits, 0, 0)
            if write:
                lanes = sum(0xFF << 8 * b for b in range(4) if strobes >> b & 1) & _mask(register)
                held[register] = held[register] & ~lanes | data & lanes
            else:
                expected[k] = held[register]
        assert device.accesses(accesses, overlap) == 0
        assert accesses["answered"].all() and len(expected) > 100
        if overlap == 1:
            assert {k: int(accesses["value"][k]) for k in expected} == expected
        for register, value in held.items():
            assert device.read_word(address(register)) == value, register
        device.set_filter(*log.kernels(1.5, TINY.radius), SIZE)
        frame = np.random.default_rng(rng.getrandbits(32)).integers(0, 256, SIZE[::-1], dtype=np.uint8)
        device.capture({0: 0, 1: 1}, {0: frame, 1: frame})
        plane = log.sign(frame, 1.5, TINY.radius)
        job = Job(0, 3, 2, 9, 8, 1, 1, 0, 7, 6, 5)
        assert device.run([job]) == [run(job, {0: plane, 1: plane}, TINY, SIZE)]
        assert np.array_equal(device.plane(1), plane) and not device.asserted


def test_power_up_states(capfd: pytest.CaptureFixture[str]) -> None:
    """No assertion fails after the reset, whatever the registers hold at power-up."""
    for power_up in (1, 2, 3):
        with Device(TINY, checked=True, power_up=power_up) as device:
            device.tick(200)
            assert not device.asserted
    assert "Assertion" not in capfd.readouterr().err
