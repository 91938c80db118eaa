# SPDX-License-Identifier: Apache-2.0
"""`slog_align` at full size against its cycle model on every clock."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.correlator.align import AlignModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import FULL
from sim.testbench.runner import simulate

ROWS = 250


def _rows(rng: random.Random, width: int, idle: float, expected: list[tuple[int, int]]) -> Stimulus:
    """Rows of 1..5 words at every shift, back to back or with pauses; idle wires are random."""
    clock = 0
    for row in range(ROWS):
        bits, shift = rng.randint(1, 4 * width), row % width
        words = [rng.getrandbits(width) for _ in range((shift + bits - 1) // width + 1)]
        whole = sum(w << k * width for k, w in enumerate(words))
        for k, word in enumerate(words):
            emit = k * width < bits
            if emit:
                left = min(bits - k * width, width)
                expected.append((whole >> shift + k * width & (1 << left) - 1, left))
            yield {"rst_i": 0, "in_valid_i": 1, "in_emit_i": int(emit), "in_data_i": word, "in_shift_i": shift,
                   "in_side_i": rng.getrandbits(8)}
            clock += 1
        while rng.random() < idle:
            yield {"rst_i": 0, "in_valid_i": 0, "in_emit_i": rng.getrandbits(1), "in_data_i": rng.getrandbits(width),
                   "in_shift_i": rng.randrange(width), "in_side_i": rng.getrandbits(8)}
    for _ in range(8):
        yield {"rst_i": 0}


@cocotb.test()
@cocotb.parametrize(idle=[0.0, 0.4])
async def every_clock(dut, idle: float) -> None:
    """Every clock as the model; the output words are the bits of the rows from their first on, after the latency."""
    rng = random.Random(cocotb.RANDOM_SEED)
    width = params()["Width"]
    expected: list[tuple[int, int]] = []
    seen: list[int] = []
    started, ended = [], []
    clock = 0

    def note(i: Inputs, out: Outputs) -> None:
        nonlocal clock
        if i["in_valid_i"] and i["in_emit_i"]:
            started.append(clock)
        if out["out_valid_o"]:
            assert out["out_data_o"] is not None
            seen.append(out["out_data_o"])
            ended.append(clock)
        clock += 1

    await check_cycles(dut, AlignModel(width), _rows(rng, width, idle, expected), note)
    assert len(seen) == len(expected) > ROWS
    assert [s & (1 << left) - 1 for s, (_, left) in zip(seen, expected, strict=True)] == [w for w, _ in expected]
    latency = 2 + ((width - 1).bit_length() + 1) // 2
    assert {b - a for a, b in zip(started, ended, strict=True)} == {latency}


@cocotb.test()
async def reset_in_a_row(dut) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    width = params()["Width"]

    def noise() -> Stimulus:
        for t in range(400):
            yield {"rst_i": int(t % 57 in (40, 41)), "in_valid_i": int(rng.random() < 0.8),
                   "in_emit_i": int(rng.random() < 0.8), "in_data_i": rng.getrandbits(width),
                   "in_shift_i": rng.randrange(width), "in_side_i": rng.getrandbits(8)}

    assert await check_cycles(dut, AlignModel(width), noise()) == 400


def test_align() -> None:
    simulate("slog_align", __name__, {"Width": FULL.group_bits, "SideW": 8})
