# SPDX-License-Identifier: Apache-2.0
"""The array's cycle models against plain counting of differing pixels."""

from __future__ import annotations

import random

import pytest

from golden.cycle.array.operand_array import OperandArrayModel
from golden.cycle.model import run_model
from golden.traffic.array import WindowTraffic
from golden.traffic.stalls import SHAPES, ready_pattern


@pytest.mark.parametrize("bubbles", SHAPES)
@pytest.mark.parametrize(("group_bits", "ring_rows", "words"), [(4, 16, 5), (8, 32, 6), (16, 64, 4)])
def test_scores_are_hamming_distances(bubbles: str, group_bits: int, ring_rows: int, words: int) -> None:
    rng = random.Random(f"{bubbles} {group_bits}")
    traffic = WindowTraffic(rng, group_bits, ring_rows, words, ready_pattern(bubbles, rng))
    model = OperandArrayModel(group_bits, ring_rows)
    model.step({**dict.fromkeys(model.INPUTS, 0), "rst_i": 1})
    run_model(model, traffic.stimulus(rounds=12, passes=4), traffic.observe)
    traffic.check()
    assert len(traffic.expected) >= 24 and traffic.clocks > 500
