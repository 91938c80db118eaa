# SPDX-License-Identifier: Apache-2.0
"""Which tests run on netlists: all cocotb tests of modules, but for those with a reason not to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Netlist = Literal["synthesised", "placed", "icarus"]


@dataclass(frozen=True)
class Item:
    """Tests of one file that run on netlists of ECP5 cells.

    Attributes:
        name: of the item: the file's name without `test_`.
        file: with the tests, within `cocotb_tests/`.
        tests: those of its pytest functions that run; all where it is empty.
        reason: why the others do not.
        netlist: `synthesised`: as Yosys makes it; `placed`: as nextpnr has packed and placed it, of the board only;
            both in Verilator. `icarus`: the board's bench in Icarus, from all-X, instead of tests.
    """

    name: str
    file: str
    tests: tuple[str, ...] = ()
    reason: str = ""
    netlist: Netlist = "synthesised"


ITEMS = (
    Item("fifo", "cells/test_fifo.py"),
    Item("mult", "cells/test_mult.py"),
    Item("ram", "cells/test_ram.py"),
    Item("ram_fifo", "cells/test_ram_fifo.py"),
    Item("packer", "frontend/test_packer.py"),
    Item("taps", "frontend/test_taps.py"),
    Item("fir", "frontend/test_fir.py"),
    Item("line_buffer", "frontend/test_line_buffer.py"),
    Item("log", "frontend/test_log.py"),
    Item("video_in", "frontend/test_video_in.py"),
    Item("frontend", "frontend/test_frontend.py"),
    Item("store", "store/test_store.py"),
    Item("capture", "store/test_capture.py"),
    Item("peek", "control/test_peek.py"),
    Item("registers", "control/test_registers.py"),
    Item("axi", "control/test_axi.py"),
    Item("control", "control/test_control.py"),
    Item("job_check", "correlator/test_job_check.py"),
    Item("job_plan", "correlator/test_job_plan.py"),
    Item("grid", "correlator/test_grid.py"),
    Item("fetch", "correlator/test_fetch.py"),
    Item("walker", "correlator/test_walker.py"),
    Item("sequencer", "correlator/test_sequencer.py"),
    Item("align", "correlator/test_align.py"),
    Item("operand_array", "array/test_operand_array.py"),
    Item("array", "array/test_array.py"),
    Item("peak_parts", "peak/test_peak_parts.py"),
    Item("peak", "peak/test_peak.py"),
    Item("correlator", "correlator/test_correlator.py"),
    Item("board", "test_board.py", ("test_board",), "clocks are gated in the fast simulation build only"),
    Item("board_races", "test_board_races.py"),
)
ELSEWHERE = {
    "test_bench_detects.py": "its modules are broken ones",
}
"""Files of `cocotb_tests/` that are in no item, with the reason."""
