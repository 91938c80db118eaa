# SPDX-License-Identifier: Apache-2.0
"""Cocotb side of `make bench`: the whole board driven on every clock, every output read, nothing compared."""

import json
import os
import random
import time
from pathlib import Path

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from cocotb_tests.env.host import Host, Script
from golden.cycle.board import BoardModel
from golden.params import CONFIGS
from sim.speed.workload import SIGMA, SIZE, frames, jobs


@cocotb.test()
async def clock_rate(dut) -> None:
    config = CONFIGS[os.environ["SLOG_BENCH_CONFIG"]]
    host = Host(config, random.Random(1))

    def script() -> Script:
        yield from host.set_up(SIGMA, SIZE)
        for slot, frame in enumerate(frames()):
            yield from host.arm(0, slot)
            host.show(0, frame)
            yield from host.captured()
        for job in jobs():
            yield from host.submit(job)
        yield from host.collect(len(jobs()))

    Clock(dut.clk_i, 10, unit="ns").start()
    inputs = {name: getattr(dut, name) for name in BoardModel.INPUTS}
    outputs = {name: getattr(dut, name) for name in BoardModel.OUTPUTS}
    for handle in inputs.values():
        handle.value = 0
    dut.rst_i.value = 1
    for _ in range(3):
        await RisingEdge(dut.clk_i)
    last = dict.fromkeys(inputs, 0) | {"rst_i": 1}
    clocks, begun = 0, time.process_time()
    stimulus = host.play(script())
    try:
        i = next(stimulus)
        while True:
            await RisingEdge(dut.clk_i)
            for name, value in i.items():
                if value != last[name]:
                    inputs[name].value = last[name] = value
            await FallingEdge(dut.clk_i)
            clocks += 1
            i = stimulus.send({name: int(handle.value) for name, handle in outputs.items()})
    except StopIteration:
        pass
    seconds = time.process_time() - begun
    results = [[r.best_x, r.best_y, r.score] for r in host.results]
    figures = {"clocks": clocks, "seconds": seconds, "results": results}
    Path(os.environ["SLOG_BENCH_OUT"]).write_text(json.dumps(figures))
