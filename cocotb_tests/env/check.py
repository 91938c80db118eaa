# SPDX-License-Identifier: Apache-2.0
"""Compares a module with its cycle model on every clock and every output.

A stimulus is a generator: it yields the inputs of a clock and receives the outputs sampled in that clock. It drives the
RTL and its model (`check_cycles`) or the model alone (`run_model`), so it can be debugged without a simulator.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer

from cocotb_tests.env.covered import Stalls
from golden.cycle.model import CycleModel, Inputs, Outputs, Stimulus
from sim.coverage.record import compared, coverage_folder, met

HISTORY = 8
"""Clocks of inputs in the message of a failure."""


async def check_cycles(
    dut: Any, model: CycleModel, stimulus: Stimulus, observe: Callable[[Inputs, Outputs], None] | None = None,
    reset_clocks: int = 2,
) -> int:
    """Drive `stimulus` into `dut` and `model` and compare every output on every clock.

    Inputs change just after the rising edge; outputs are sampled at the falling edge, so paths from input to output
    within a clock are checked too. The model is stepped during reset, but its outputs there are not compared
    (the power-up state is random).

    Returns:
        Clocks compared.

    Raises:
        AssertionError: naming the clock, the signal, both values and the last inputs.
    """
    handles = {name: getattr(dut, name) for name in (*model.INPUTS, *model.OUTPUTS)}
    idle = dict.fromkeys(model.INPUTS, 0)
    # Reset is asserted before the first edge: assertions must not be evaluated on the random power-up state.
    dut.clk_i.value = 0
    for name in model.INPUTS:
        handles[name].value = int(name == "rst_i")
    await Timer(1, unit="ns")
    clock = Clock(dut.clk_i, 10, unit="ns")
    task = clock.start()
    for _ in range(reset_clocks):
        await RisingEdge(dut.clk_i)
        for name in model.INPUTS:
            handles[name].value = int(name == "rst_i")
        await FallingEdge(dut.clk_i)
        model.step({**idle, "rst_i": 1})
    history: deque[tuple[int, Inputs]] = deque(maxlen=HISTORY)
    last: Inputs = {**idle, "rst_i": 1}
    clocks = 0
    undefined = dict.fromkeys(model.OUTPUTS, 0)
    stalls = Stalls((*model.INPUTS, *model.OUTPUTS)) if coverage_folder() else None
    try:
        i = {**idle, **next(stimulus)}
        while True:
            await RisingEdge(dut.clk_i)
            for name, value in i.items():
                if value != last[name]:
                    handles[name].value = value
            last = i
            await FallingEdge(dut.clk_i)
            expected = model.step(i)
            history.append((clocks, i))
            seen: dict[str, int | None] = {}
            for name in model.OUTPUTS:
                got = int(handles[name].value)
                want = expected[name]
                seen[name] = got if want is not None else None
                undefined[name] += want is None
                if want is not None and got != want:
                    trail = "\n".join(f"  clock {t}: {v}" for t, v in history)
                    raise AssertionError(
                        f"clock {clocks}: {name}: RTL {got:#x}, model {want:#x}; seed {cocotb.RANDOM_SEED}\n{trail}")
            clocks += 1
            if stalls:
                stalls.observe(i, seen)
            if observe:
                observe(i, seen)
            i = {**idle, **stimulus.send(seen)}
    except StopIteration:
        pass
    task.cancel()
    compared(dut._name, clocks, undefined)
    if stalls:
        met(f"stalls of {dut._name}", stalls.counts)
    return clocks
