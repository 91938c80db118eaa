# SPDX-License-Identifier: Apache-2.0
"""`slog_operands` feeding `slog_array`, against their cycle models on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.array.operand_array import OperandArrayModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import TINY
from golden.structs import STEP
from golden.traffic.array import WindowTraffic
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate


def _windows(rng: random.Random, bubbles: str) -> WindowTraffic:
    p = params()
    return WindowTraffic(rng, p["GroupBits"], p["RingRows"], p["WordsPerRow"], ready_pattern(bubbles, rng))


def _model() -> OperandArrayModel:
    return OperandArrayModel(params()["GroupBits"], params()["RingRows"], bool(params()["HoldIdle"]))


@cocotb.test()
@cocotb.parametrize(bubbles=SHAPES)
async def windows(dut, bubbles: str) -> None:
    """Every clock as the model; every score as by plain counting, in order and at its clock."""
    big = params()["GroupBits"] > 16
    traffic = _windows(random.Random(cocotb.RANDOM_SEED), bubbles)
    stimulus = traffic.stimulus(3 if big else 14, 3 if big else 5)
    await check_cycles(dut, _model(), stimulus, traffic.observe)
    traffic.check()
    assert len(traffic.expected) >= (3 if big else 20)


@cocotb.test()
async def reset_in_mid_pass(dut) -> None:
    """Two resets while passes are in flight; the memories keep their words, scores in flight are gone."""
    traffic = _windows(random.Random(cocotb.RANDOM_SEED), "random")
    stimulus = traffic.stimulus(14, 4)
    scores = resets = 0

    def watch(i: Inputs, out: Outputs) -> None:
        nonlocal scores
        scores += bool(out["mismatch_valid_o"])

    def with_resets() -> Stimulus:
        nonlocal resets
        busy = quiet = 0
        i = next(stimulus)
        try:
            while True:
                step = STEP.unpack(i["step_i"])
                busy += step["valid"]
                ends = step["valid"] and step["last"]  # its scores are still to come
                i["rst_i"] = int(resets < 2 and busy > 25 * (resets + 1) and bool(quiet or ends))
                quiet = int(i["rst_i"] and not quiet)
                resets += quiet
                i = stimulus.send((yield i))
        except StopIteration:
            return

    await check_cycles(dut, _model(), with_resets(), watch)
    expected = sum(map(len, traffic.expected))
    assert resets == 2 and expected // 4 < scores < expected


@pytest.mark.parametrize(("group_bits", "ring_rows", "words", "hold_idle"), [
    (TINY.group_bits, TINY.ring_rows, TINY.words_per_row, 1), (16, 64, 10, 0)])
def test_operand_array(group_bits: int, ring_rows: int, words: int, hold_idle: int) -> None:
    simulate("tb_operand_array", __name__,
             {"GroupBits": group_bits, "RingRows": ring_rows, "WordsPerRow": words, "HoldIdle": hold_idle})
