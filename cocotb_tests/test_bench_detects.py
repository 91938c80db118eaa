# SPDX-License-Identifier: Apache-2.0
"""The test bench itself: broken RTL must fail the comparison, and the message must name clock and signal."""

from pathlib import Path

import pytest

from sim.testbench.runner import simulate
from sim.toolchain import RTL

BREAKS = {
    "late pointer": ("mem_q[head_q]", "mem_q[after(head_q)]", r"clock \d+: out_data_o: RTL"),
    "off by one": ("in_ready_o  = !held_q[Depth]", "in_ready_o  = !held_q[Depth-1]", r"clock \d+: in_ready_o: RTL"),
    "lost word": ("push        = in_valid_i &&", "push        = in_valid_i && !pop &&", r"clock \d+: \w+: RTL"),
}


@pytest.mark.parametrize("name", BREAKS)
def test_broken_rtl_is_found(name: str, tmp_path: Path) -> None:
    """One defect of the FIFO at a time; without it the FIFO passes `test_fifo.py`."""
    right, wrong, message = BREAKS[name]
    source = (RTL / "cells" / "slog_fifo.sv").read_text()
    assert source.count(right) == 1
    broken = tmp_path / "slog_fifo.sv"
    broken.write_text(source.replace(right, wrong))
    with pytest.raises(AssertionError, match=message):
        simulate("slog_fifo", "cocotb_tests.cells.test_fifo", {"Width": 8, "Depth": 4}, replaced={"slog_fifo": broken})
