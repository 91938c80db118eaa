"""The array's cycle models against plain counting of differing pixels."""

from __future__ import annotations

import random

import pytest

from golden.cycle.array.operand_array import OperandArrayModel
from golden.cycle.array.timing import array_latency
from golden.cycle.model import Inputs, Outputs, run_model
from golden.structs import STEP
from golden.traffic.array import WindowTraffic
from golden.traffic.stalls import SHAPES, willing


@pytest.mark.parametrize("bubbles", SHAPES)
@pytest.mark.parametrize(("group_bits", "ring_rows", "words"), [(4, 16, 5), (8, 32, 6), (16, 64, 4)])
def test_scores_are_hamming_distances(bubbles: str, group_bits: int, ring_rows: int, words: int) -> None:
    rng = random.Random(f"{bubbles} {group_bits}")
    traffic = WindowTraffic(rng, group_bits, ring_rows, words, willing(bubbles, rng))
    seen: list[tuple[int, int]] = []
    due: list[int] = []
    clock = 0

    def watch(i: Inputs, out: Outputs) -> None:
        nonlocal clock
        step = STEP.unpack(i["step_i"])
        if step["valid"] and step["last"]:
            due.extend(clock + array_latency(group_bits) + k for k in range(step["lanes"]))
        if out["mismatch_valid_o"]:
            seen.append((clock, out["mismatch_o"] or 0))
        clock += 1

    model = OperandArrayModel(group_bits, ring_rows)
    model.step({**dict.fromkeys(model.INPUTS, 0), "rst_i": 1})
    run_model(model, traffic.inputs(rounds=12, passes=4), watch)
    assert [value for _, value in seen] == [value for scores in traffic.expected for value in scores]
    assert [t for t, _ in seen] == due
    assert len(traffic.expected) >= 24 and clock > 500
