# SPDX-License-Identifier: Apache-2.0
"""A scenario of every board: what its inputs are offered waits for any number of clocks."""

from __future__ import annotations

from cocotb_tests.env.host import Host, Script
from sim.coverage.functional import FEW, MANY
from sim.registers.map import address, word


def offers_at_every_moment(h: Host) -> Script:
    """A beat that comes at any clock of a change of filter waits for its end, a request that comes at any clock of a
    write for the write's: for a clock, for some, for many. None is lost."""
    beats, waited = 0, [0]
    while not (1 in waited and max(waited) >= MANY and any(FEW <= clocks < MANY for clocks in waited)):
        assert beats < 100, f"clocks for which beats waited: {waited}"
        before = h.stalls["video"]
        h.master.write(address("filter"), word("filter", go=1))
        yield from h.pause(beats)
        h.beats[beats % 2].append((h.rng.getrandbits(8), 1, 1))  # a frame of one beat, which is dropped and counted
        beats += 1
        yield from h.until(lambda: not any(h.beats), "video")
        waited.append(h.stalls["video"] - before)
        while (yield from h.read("filter.busy")):
            pass
    drops = yield from h.read("counter.drops[0].value")
    assert drops + (yield from h.read("counter.drops[1].value")) == beats
    h.master.overlap = 2
    for gap in range(2 * MANY):
        values = [h.rng.getrandbits(4) for _ in range(2)]
        for value in values:
            h.master.write(address("irq_enable"), value)
            yield from h.pause(gap)
        yield from h.until(lambda: h.master.idle, "bus")
        for _ in range(2):
            access = h.master.read(address("irq_enable"))
            yield from h.pause(gap)
        yield from h.until(lambda: h.master.idle, "bus")
        assert access.data == values[-1]
    h.master.overlap = 1
