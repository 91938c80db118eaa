# SPDX-License-Identifier: Apache-2.0
"""Drives a module by a stimulus that checks what comes out by itself, without a cycle model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer

from golden.cycle.model import Stimulus

RESET_CLOCKS = 2


async def drive(dut: Any, inputs: Sequence[str], outputs: Sequence[str], stimulus: Stimulus) -> int:
    """Drive `stimulus` into the ports `inputs` of `dut`, after a reset, and hand it the values of `outputs`.

    Ports change and are sampled as by `cocotb_tests.env.check.check_cycles`.

    Returns:
        Clocks driven.
    """
    ports = {name: getattr(dut, name) for name in (*inputs, *outputs)}
    dut.clk_i.value = 0
    for name in inputs:
        ports[name].value = int(name == "rst_i")
    await Timer(1, unit="ns")
    task = Clock(dut.clk_i, 10, unit="ns").start()
    for _ in range(RESET_CLOCKS):
        await FallingEdge(dut.clk_i)
    clocks = 0
    try:
        values = next(stimulus)
        while True:
            await RisingEdge(dut.clk_i)
            for name in inputs:
                ports[name].value = values.get(name, 0)
            await FallingEdge(dut.clk_i)
            clocks += 1
            values = stimulus.send({name: int(ports[name].value) for name in outputs})
    except StopIteration:
        pass
    task.cancel()
    return clocks
