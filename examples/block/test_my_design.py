# SPDX-License-Identifier: Apache-2.0
"""Plain cocotb test of `my_design`: frames in, the number of positive signs out, against the golden LoG."""

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge

from golden.log import sign

WIDTH, HEIGHT, SIGMA, RADIUS = 48, 36, 2.0, 8


async def send(dut, image) -> None:
    """One frame as AXI4-Stream video: tuser at its first pixel, tlast at the end of each line."""
    for y, row in enumerate(image):
        for x, pixel in enumerate(row):
            dut.tvalid_i.value, dut.tdata_i.value = 1, int(pixel)
            dut.tuser_i.value, dut.tlast_i.value = int(x == y == 0), int(x == WIDTH - 1)
            await RisingEdge(dut.clk_i)
            while not dut.tready_o.value:
                await RisingEdge(dut.clk_i)
    dut.tvalid_i.value = 0


@cocotb.test()
async def counts_signs(dut) -> None:
    """Three frames back to back."""
    Clock(dut.clk_i, 10, unit="ns").start()
    for port in (dut.tdata_i, dut.tvalid_i, dut.tuser_i, dut.tlast_i):
        port.value = 0
    dut.rst_i.value = 1
    for _ in range(4):
        await RisingEdge(dut.clk_i)
    dut.rst_i.value = 0
    rng = np.random.default_rng(1)
    frames = [rng.integers(0, 256, (HEIGHT, WIDTH), np.uint8) for _ in range(3)]

    async def show() -> None:
        for frame in frames:
            await send(dut, frame)

    cocotb.start_soon(show())
    for frame in frames:
        await RisingEdge(dut.clk_i)
        while not dut.done_o.value:
            await RisingEdge(dut.clk_i)
        assert int(dut.ones_o.value) == sign(frame, SIGMA, RADIUS).sum()
