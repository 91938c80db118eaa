# SPDX-License-Identifier: Apache-2.0
"""Timing diagrams of the documentation, drawn from a simulation of the RTL."""

from __future__ import annotations

import os
from typing import Any

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from docs.tools.waves import IMAGES, WAVES, Seen, draw, ports, stimulus
from golden.cycle.model import CycleModel, Inputs, Outputs


async def check_diagram(dut: Any, room: str, model: CycleModel) -> None:
    """Drive the stimulus of a room's timing diagram into `dut` and compare the picture with the one that is kept.

    A value is left out where the cycle model says that it means nothing. Benches of other parameters than the diagram's
    have nothing to compare. With DIAGRAMS=write in the environment the picture is written instead.

    Raises:
        AssertionError: if the pictures differ, or RTL and model do.
    """
    wave = WAVES[room]()
    if params() != wave.parameters:
        return
    seen: list[Seen] = []

    def observe(i: Inputs, out: Outputs) -> None:
        seen.append(ports(wave, {**i, **out}))

    await check_cycles(dut, model, stimulus(wave, model.INPUTS), observe)
    path = IMAGES / f"waves-{room}.svg"
    if os.environ.get("DIAGRAMS") == "write":
        path.write_text(draw(wave, seen))
    assert path.read_text() == draw(wave, seen), f"{path.name} has changed: run python -m docs.tools.waves {room}"
