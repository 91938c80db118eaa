# SPDX-License-Identifier: Apache-2.0
"""`slog_log` against its cycle model on every clock."""

import random

import cocotb
import numpy as np
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.bits import pack_coefs
from golden.cycle.frontend.log import LogModel, pixel_inputs
from golden.cycle.frontend.video_in import VideoInModel
from golden.cycle.model import Inputs, Outputs, Stimulus, run_model
from golden.log import kernels
from golden.params import FULL, TINY
from golden.traffic.stalls import ready_pattern
from golden.traffic.video import bad, good, play, texture
from sim.testbench.runner import simulate


def _recorded(rng: random.Random, radius: int, width: int, height: int, shape: str) -> list[Inputs]:
    """Inputs of every clock of a few frames, good ones and one that is dropped half-way."""
    clocks: list[Inputs] = []
    faint = np.random.default_rng(1).integers(126, 130, (height, width), dtype=np.uint8)
    items = [good(texture(rng, width, height)), good(texture(rng, width, height)),
             bad("cut_line", texture(rng, width, height), rng), good(texture(rng, width, height)), good(faint)]
    run_model(VideoInModel(radius), play(items, {"width_i": width, "height_i": height}, ready_pattern(shape, rng), rng),
              lambda _, out: clocks.append(pixel_inputs(out)))
    return clocks


@cocotb.test()
@cocotb.parametrize(more=((2, 2), (15, 4), (32, 3)), sigma=(1.0, 4.0, None))
async def every_clock(dut, more: tuple[int, int], sigma: float | None) -> None:
    """LoG kernels, and small ones under which the rounding between the passes decides many signs; `more`: columns and
    rows of the image beyond the window's."""
    p = params()
    size = 2 * p["Radius"] + more[0], 2 * p["Radius"] + more[1]
    rng = random.Random(cocotb.RANDOM_SEED)
    shape = rng.choice(("none", "random"))
    rest = (0,) * (p["Radius"] - 2)
    g, g2 = kernels(sigma, p["Radius"]) if sigma else ((33, 15, *rest, 1), (-62, 30, *rest, 1))
    coefs = {"g_i": pack_coefs(g), "g2_i": pack_coefs(g2)}
    clocks = _recorded(rng, p["Radius"], *size, shape)
    bits = [0, 0]

    def stimulus() -> Stimulus:
        for px in clocks:
            yield {**coefs, **px}
        for n in range(LogModel(p["MaxWidth"], p["Radius"]).latency + 2):
            yield {**coefs, "rst_i": int(more[0] == 15 and n == 20)}  # a reset with the last row under way

    def count(i: Inputs, out: Outputs) -> None:
        if out["bit_valid_o"]:
            assert out["bit_o"] is not None
            bits[out["bit_o"]] += 1

    await check_cycles(dut, LogModel(p["MaxWidth"], p["Radius"]), stimulus(), count)
    assert min(bits) > size[0] * size[1]


@pytest.mark.parametrize(("width", "radius"), [(TINY.max_width, TINY.radius), (64, FULL.radius)])
def test_log(width: int, radius: int) -> None:
    simulate("slog_log", __name__, {"MaxWidth": width, "Radius": radius})
