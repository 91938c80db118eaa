# SPDX-License-Identifier: Apache-2.0
"""The parts of `slog_peak`, each against its cycle model on every clock, all in one bench (`tb_peak_parts`)."""

import random
from collections import Counter

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.diagram import check_diagram
from cocotb_tests.env.params import params
from golden.correlate import Status
from golden.cycle.cells.stage import StageModel
from golden.cycle.model import CycleModel, Inputs, Outputs, Stimulus, Values
from golden.cycle.peak.peak import BANKS
from golden.cycle.peak.peak_best import PeakBestModel
from golden.cycle.peak.peak_collect import PeakCollectModel
from golden.cycle.peak.peak_intake import PeakIntakeModel
from golden.cycle.peak.peak_room import PeakRoomModel
from golden.cycle.peak.peak_rows import PeakRowsModel
from golden.cycle.peak.peak_scan import PeakScanModel
from golden.cycle.peak.running_max import RunningMaxModel
from golden.cycle.peak.structs import OUTCOME, PRESENT, SCAN, SCORE_ROW, SCORING
from golden.params import SCORE_BITS
from golden.structs import CONTEXT, Layout
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate

LONG, SHORT = 225, 15
"""Clocks from one reset to the next, twice and ten times: resets meet every stage at work."""
FEW = 3
"""Largest score where ties are wanted."""


class _SideBySide:
    """Several cycle models as one, the names of each behind a prefix."""

    def __init__(self, **parts: CycleModel) -> None:
        self.parts = parts
        self.INPUTS = ("rst_i", *(f"{p}_{n}" for p, m in parts.items() for n in m.INPUTS if n != "rst_i"))
        self.OUTPUTS = tuple(f"{p}_{n}" for p, m in parts.items() for n in m.OUTPUTS)

    def step(self, i: Inputs) -> Values:
        out: Values = {}
        for p, model in self.parts.items():
            own = {n: i["rst_i"] if n == "rst_i" else i[f"{p}_{n}"] for n in model.INPUTS}
            out |= {f"{p}_{n}": v for n, v in model.step(own).items()}
        return out


def _anything(rng: random.Random, layout: Layout, **fixed: int) -> int:
    return layout.pack({name: fixed.get(name, rng.getrandbits(bits)) for name, bits in layout.fields})


def _maybe(rng: random.Random, top: int) -> int:
    """A score that may be absent."""
    return PRESENT + rng.randint(0, top) if rng.random() < 0.8 else 0


def _stage(rng: random.Random, shape: str) -> Stimulus:
    offer, take = ready_pattern("random", rng), ready_pattern(shape, rng)
    held = 0
    while True:
        held = held or next(offer) * rng.randint(1, 4095)
        out = yield {"in_valid_i": int(held > 0), "in_data_i": held or rng.getrandbits(12), "out_ready_i": next(take)}
        held *= not out["in_ready_o"]


def _room(rng: random.Random, shape: str) -> Stimulus:
    widest, ask, leave = params()["MaxOffsets"], ready_pattern(shape, rng), ready_pattern("random", rng)
    held = 0
    while True:
        i = {"row_valid_i": next(ask), "row_offsets_i": rng.randint(1, widest),
             "taken_i": int(held > 0 and next(leave))}
        out = yield i
        held += i["row_offsets_i"] * (i["row_valid_i"] and out["row_ready_o"]) - i["taken_i"]


def _rows(rng: random.Random, shape: str) -> Stimulus:
    offer, take = ready_pattern("random", rng), ready_pattern(shape, rng)
    there, held = 0, None
    while True:
        ok = rng.random() < 0.7
        ctx = _anything(rng, CONTEXT, status=0 if ok else rng.randint(1, 4), offsets_x=rng.choice((1, 2, 3, 640)),
                       offsets_y=rng.randint(1, 5) if ok else rng.getrandbits(10))
        held = ctx if held is None and next(offer) else held  # what is offered stays
        i = {"ctx_valid_i": int(held is not None), "ctx_i": ctx if held is None else held,
             "row_taken_i": int(there and next(take))}
        out = yield i
        held = None if out["ctx_ready_o"] else held
        there = not i["row_taken_i"] and out["row_coming_o"]


def _intake(rng: random.Random, shape: str) -> Stimulus:
    scores, surf = ready_pattern(shape, rng), ready_pattern("cyclic", rng)
    used, coming, row, taken = 0, None, None, 0
    top = (1 << params()["ScoreBits"]) - 1
    while True:
        last_x = rng.choice((0, 0, 1, 2, 9, 40))
        coming = coming or {"row_refused_i": int(rng.random() < 0.1), "row_last_x_i": last_x,
                            "row_first_i": rng.getrandbits(1), "row_last_i": rng.getrandbits(1),
                            "scoring_i": _anything(rng, SCORING, area=rng.randint(1, 256), one=int(last_x == 0),
                                                  two=int(last_x == 1))}
        area = row["scoring_i"] % PRESENT if row else top
        i = {**coming, "row_coming_i": int(rng.random() < 0.9), "mismatch_valid_i": next(scores),
             "mismatch_i": rng.randint(0, min(area, top)), "surf_ok_i": next(surf),
             "released_i": rng.randint(0, min(used, 2)) if rng.random() < 0.2 else 0}
        out = yield i
        used -= i["released_i"]
        # A row remains for one clock after it was taken.
        coming = None if taken else coming
        taken = out["row_taken_o"]
        if taken:
            used, row = used + 1, coming


def _running_max(rng: random.Random, shape: str) -> Stimulus:
    offer = ready_pattern(shape, rng)
    while True:
        count = rng.choice((1, 1, 2, 3, 4, 17))
        top = rng.choice((1, FEW, PRESENT - 1))
        start = rng.randint(0, 900)
        for k in range(count):
            while not next(offer):
                yield {"in_valid_i": 0, **{n: rng.getrandbits(1) for n in ("in_first_i", "in_last_i", "in_value_i")}}
            yield {"in_valid_i": 1, "in_first_i": int(k == 0), "in_last_i": int(k == count - 1),
                   "in_value_i": rng.randint(0, top), "in_index_i": start + k}


def _best(rng: random.Random, shape: str) -> Stimulus:
    """Rows of jobs; the maxima of some of the waiting rows have arrived."""
    take, room_there = ready_pattern(shape, rng), ready_pattern("cyclic", rng)
    waiting: list[int] = []
    tops: list[tuple[int, int]] = []
    coming: tuple[int, int] | None = None
    y, left, status, top, last_x = 0, 0, 0, FEW, 0
    while True:
        if len(waiting) < BANKS and rng.random() < 0.7:
            if not left:
                y, top = 0, rng.choice((0, FEW, PRESENT - 1))
                status = rng.choice((0, 0, 0, rng.randint(1, 4)))
                left = 1 if status else rng.randint(1, 6)
                last_x = rng.choice((0, 0, 1, 2, rng.getrandbits(10)))
            waiting.append(_anything(rng, SCORE_ROW, status=status, first=int(y == 0), last=int(left == 1), y=y,
                                     last_x=last_x))
            y, left = y + 1, left - 1
        pending = sum(SCORE_ROW.unpack(w)["status"] == Status.OK for w in waiting)
        tops += [coming] if coming else []
        coming = (rng.randint(0, top), rng.getrandbits(10)) if len(tops) < pending and rng.random() < 0.6 else None
        out = yield {"row_valid_i": int(bool(waiting)), "row_i": waiting[0] if waiting else rng.getrandbits(41),
                     "top_level_i": len(tops), "top_coming_i": int(coming is not None),
                     "top_score_i": tops[0][0] if tops else rng.getrandbits(15), "top_x_i": tops[0][1] if tops else 5,
                     "room_i": next(room_there), "order_room_i": next(take)}
        if out["row_ready_o"]:
            waiting.pop(0)
        if out["top_ready_o"]:
            tops.pop(0)


def _scan(rng: random.Random, shape: str) -> Stimulus:
    offer = ready_pattern(shape, rng)
    data, room = [0] * BANKS, 0
    while True:
        last_x = rng.choice((0, 0, 1, 2, 6, 23))
        top = rng.choice((1, FEW, PRESENT - 1))
        only = int(not last_x or rng.random() < 0.2)
        order = _anything(rng, SCAN, only=only, brief=int(only or last_x == 1), last_x=last_x,
                         best_x=rng.choice((0, last_x, rng.randint(0, last_x))))
        while True:
            data = [rng.randint(0, top) for _ in range(BANKS)]
            i = {"order_valid_i": int(room and next(offer)), "order_i": order,
                 "data_i": sum(d << b * SCORE_BITS for b, d in enumerate(data))}
            out = yield i
            room = out["order_room_o"] and not i["order_valid_i"]
            if i["order_valid_i"]:
                break


def _collect(rng: random.Random, shape: str) -> Stimulus:
    ends = ready_pattern(shape, rng)
    # A job begins with a first column, and a first row holds the best so far.
    yield {"near_first_i": 1, "far_valid_i": 1, "far_i": _maybe(rng, FEW),
           "outcome_i": _anything(rng, OUTCOME, fresh=1, other=_maybe(rng, FEW), score=_maybe(rng, FEW))}
    far = 1
    while True:
        top = rng.choice((1, FEW, PRESENT - 1))
        far = int(not far and next(ends))
        flags = {f"near_{n}_i": int(rng.random() < 0.3) for n in ("first", "end", "west", "centre", "east")}
        yield {**flags, "far_valid_i": far, "far_i": _maybe(rng, top),
               **{f"near_{n}_i": _maybe(rng, top) for n in ("above", "middle", "below")},
               "outcome_i": _anything(rng, OUTCOME, other=_maybe(rng, top), score=_maybe(rng, top))}


TRAFFIC = {"stage": _stage, "half": _stage, "room": _room, "rows": _rows, "intake": _intake, "max": _running_max,
           "best": _best, "scan": _scan, "collect": _collect}
COUNTED = ("stage_out_valid_o", "half_out_valid_o", "room_row_ready_o", "rows_row_coming_o",
           "intake_score_valid_o", "intake_surf_valid_o",
           "max_out_valid_o", "best_order_valid_o", "scan_near_first_o", "scan_far_valid_o", "collect_around_valid_o",
           "collect_verdict_valid_o")


def _together(rng: random.Random, shape: str) -> Stimulus:
    """All stimuli in parallel, begun anew after each of many resets."""
    for clocks in (LONG, LONG, *(SHORT + rng.randint(-9, 9) for _ in range(10))):
        running = {p: make(rng, shape) for p, make in TRAFFIC.items()}
        wanted = {p: next(g) for p, g in running.items()}
        for t in range(clocks):
            rst = int(t == clocks - 1)
            out = yield {"rst_i": rst, **{f"{p}_{n}": v for p, i in wanted.items() for n, v in i.items()}}
            if not rst:
                wanted = {p: g.send({n.removeprefix(f"{p}_"): v for n, v in out.items() if n.startswith(f"{p}_")})
                          for p, g in running.items()}


def _parts() -> _SideBySide:
    """The models of all parts in the bench."""
    p = params()
    return _SideBySide(stage=StageModel(), half=StageModel(half=True), rows=PeakRowsModel(),
                       room=PeakRoomModel(p["ScoreDepth"], p["MaxOffsets"]),
                       intake=PeakIntakeModel(BANKS), max=RunningMaxModel(), best=PeakBestModel(),
                       scan=PeakScanModel(BANKS), collect=PeakCollectModel())


@cocotb.test()
@cocotb.parametrize(shape=SHAPES)
async def every_clock(dut, shape: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    seen: Counter[str] = Counter()

    def count(_: Inputs, out: Outputs) -> None:
        seen.update(n for n in COUNTED if out[n])

    await check_cycles(dut, _parts(), _together(rng, shape), count)
    assert all(seen[n] >= 10 for n in COUNTED), seen


@cocotb.test()
async def timing_diagram(dut) -> None:
    await check_diagram(dut, "peak", _parts())


def test_peak_parts() -> None:
    simulate("tb_peak_parts", __name__, {"MaxOffsets": 48, "ScoreBits": 9, "ScoreDepth": 128})
