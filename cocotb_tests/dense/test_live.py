# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_live` against its cycle model on every clock, and against what the cameras did.

The cameras keep the promises of `slog_capture`; requests begin and end at any time before and after a pass' begin.
"""

import random
from collections import Counter
from collections.abc import Generator

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.dense.live import ABSENT, AWAITED, FOLLOWED, LOST, WHOLE, DenseLiveModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.cycle.store.capture_channel import PROGRESS
from golden.traffic.lasting import lasting
from golden.traffic.live import FATES, CameraRequest, Shown, camera
from sim.coverage.record import met
from sim.testbench.runner import simulate

PASSES = 150
LATENCY = 4
"""Clocks from a camera's row to `there_o`."""
BEGINS = {ABSENT: "absent", AWAITED: "awaited", FOLLOWED: "being written", WHOLE: "whole"}
POINTS = {*BEGINS.values(), "same slot", "size changed", "row above the plane", "row below the plane",
          *(f"frame {fate}" for fate in FATES), "lost before it began", "whole after it was awaited", "not live",
          "whole in this clock", "size changed at the begin", "slot absent"}


class Cameras:
    """Two cameras that get one request after another, for different slots, and the slots that hold a frame."""

    def __init__(self, rng: random.Random, slots: int, seen: Counter[str]) -> None:
        self.rng, self.seen, self.valid = rng, seen, rng.getrandbits(slots)
        self.requests: list[CameraRequest | None] = [None, None]
        self.running: list[Generator[Shown, bool, None] | None] = [None, None]
        self.kept = 0  # slots that the pass keeps

    def ask(self, c: int, slots: list[int]) -> None:
        """Give camera c a request for one of `slots`, if it has none and the other camera does not hold the slot."""
        other = self.requests[1 - c]
        if self.running[c] or (other and other.slot in slots):
            return
        rng = self.rng
        rows = rng.randint(1, 12)
        request = CameraRequest(rng.choice(slots), rows, rng.choice(((1, 1), (1, 9), (9, 30))), rng.choice((0, 3, 40)),
                          rng.choice((*FATES, "whole", "whole", "whole")), rng.randint(0, rows),
                          rng.choice((0, 20)), 6 + c)
        running = camera(request, rng)
        next(running)  # so that it can be sent whether its slot is kept
        self.requests[c], self.running[c] = request, running

    def clock(self) -> int:
        """Progress of both cameras in this clock."""
        word = 0
        for c in (0, 1):
            running, request = self.running[c], self.requests[c]
            if running is None or request is None:
                continue
            try:
                shown = running.send(bool(self.kept >> request.slot & 1))
            except StopIteration:
                self.running[c] = self.requests[c] = None
                self.seen[f"frame {request.fate}"] += 1
                continue
            word |= shown.progress << 16 * c
            if shown.valid is not None:
                bit = 1 << shown.slot
                self.valid = self.valid | bit if shown.valid else self.valid & ~bit
        return word


def _passes(rng: random.Random, model: DenseLiveModel, seen: Counter[str]) -> Stimulus:
    """Passes, live and not, over slots in every state, until each of POINTS is in `seen`."""
    cameras, most = Cameras(rng, model.slots, seen), model.slots
    for _ in range(2):  # with the reset, the pause before a pass
        yield {}
    for number in lasting(PASSES, 20 * PASSES, lambda: all(seen[name] for name in POINTS)):
        slots = [rng.randrange(most), rng.randrange(most)]
        live, down = int(rng.random() < 0.85), rng.choice((0, 0, rng.randint(-4, 4), rng.randint(-14, 14), -512, 511))
        if rng.random() < 0.2:
            slots[1] = slots[0]
        chosen = [0 if rng.random() < 0.05 else 1 << slot for slot in slots]
        job = {"live_i": live, "slots_i": chosen[0] | chosen[1] << most, "down_i": down & 0x3FF}
        for c in (0, 1):
            if rng.random() < 0.85:
                cameras.ask(c, [slots[c]] if rng.random() < 0.8 else [rng.randrange(most)])
        until_done, clears = rng.random() < 0.3, rng.random() < 0.1
        before = rng.choice((0, 1, 2, 30, rng.randint(1, 90)))
        for clock in range(300 if until_done else before):
            now, last = cameras.clock(), clock == before - 1
            yield {**job, "live_i": rng.getrandbits(1), "progress_i": now, "slot_valid_i": cameras.valid,
                   "down_i": rng.getrandbits(10), "clear_i": int(clears and last)}
            if until_done and any(PROGRESS.unpack(now >> PROGRESS.bits * c)["done"] for c in (0, 1)):
                seen["whole in this clock"] += live
                break
        seen["size changed at the begin"] += clears and not until_done and before > 0 and live
        waits = begin = clocks = rows = 0
        quit_at = rng.choice((rng.randint(1, 60), 500, 500, 500))
        clear_at = rng.choice((0, 1, rng.randint(0, 60))) if rng.random() < 0.25 else -1
        reset_at = rng.randint(1, 60) if number % 16 == 7 else -1
        states = [ABSENT, ABSENT]
        ahead: list[int] = []
        ended = 0
        while clocks < quit_at and ended < 12:
            now = cameras.clock()
            if not clocks % 7 and not ended:
                for c in (0, 1):
                    if rng.random() < 0.1:
                        cameras.ask(c, [rng.randrange(most)])
            row = int(waits > 3 and bool(ahead) and ahead[-1] == 1 and rows < 14 and rng.random() < 0.6)
            out = yield {**job, "begin_i": int(clocks == begin), "reading_i": 1, "row_i": row, "progress_i": now,
                         "slot_valid_i": cameras.valid, "clear_i": int(clocks == clear_at),
                         "rst_i": int(clocks == reset_at)}
            seen["size changed"] += clocks == clear_at and live
            cameras.kept = sum({slot for p, slot in enumerate(chosen) if out["keep_o"] >> p & 1})
            ahead.append(out["there_o"] if clocks > LATENCY else 0)
            waits = 0 if row else waits + 1
            seen["row above the plane"] += row and rows < down and live
            seen["row below the plane"] += row and rows - down > 12 and live
            rows += row
            earlier, states = states, list(model.states)
            if clocks == 0 and live:
                for state in states:
                    seen[BEGINS[state]] += 1
                seen["same slot"] += chosen[0] == chosen[1] != 0
                seen["slot absent"] += 0 in chosen
            for was, state in zip(earlier, states, strict=True):
                seen["lost before it began"] += (was, state) == (AWAITED, LOST)
                seen["whole after it was awaited"] += clocks > 1 and was in (AWAITED, FOLLOWED) and state == WHOLE
            ended += bool(out["lost_o"]) or (bool(out["whole_o"]) and clocks > LATENCY and rows > 10)
            clocks += 1
            if clocks > reset_at > 0:
                break
        seen["not live"] += not live
        cameras.kept = 0
        for _ in range(rng.randint(3, 6)):  # the shortest pause between passes is 3 clocks
            yield {**job, "progress_i": cameras.clock(), "slot_valid_i": cameras.valid}


@cocotb.test()
async def every_clock(dut) -> None:
    rng, seen = random.Random(cocotb.RANDOM_SEED), Counter[str]()
    model = DenseLiveModel(slots=params().get("Slots", 8))
    def watch(i: Inputs, out: Outputs) -> None:
        assert not (i["live_i"] and out["lost_o"] and out["whole_o"])

    await check_cycles(dut, model, _passes(rng, model, seen), watch)
    seen = Counter({name: count for name, count in seen.items() if count})
    met("planes of live passes", {name: seen[name] for name in sorted(POINTS)})
    assert seen.keys() >= POINTS, POINTS - seen.keys()


@pytest.mark.parametrize("slots", [8, 3])
def test_live(slots: int) -> None:
    simulate("slog_dense_live", __name__, {"Slots": slots})
