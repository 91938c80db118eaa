# SPDX-License-Identifier: Apache-2.0
"""Which tests run on netlists: all cocotb tests of modules, but for those with a reason not to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Netlist = Literal["synthesised", "icarus", "routed"]


@dataclass(frozen=True)
class GateItem:
    """Tests of one file that run on netlists of ECP5 cells.

    Attributes:
        name: of the item: the file's name without `test_`.
        file: with the tests, within `cocotb_tests/`.
        tests: those of its pytest functions that run; all where it is empty.
        reason: why the others do not.
        netlist: `synthesised`: as Yosys makes it, in Verilator. `icarus`, `routed`: the board's in Icarus, from all-X,
            with a bench instead of tests, as Yosys makes it and as nextpnr places and routes it.
    """

    name: str
    file: str
    tests: tuple[str, ...] = ()
    reason: str = ""
    netlist: Netlist = "synthesised"


ITEMS = (
    GateItem("fifo", "cells/test_fifo.py"),
    GateItem("mult", "cells/test_mult.py"),
    GateItem("ram", "cells/test_ram.py"),
    GateItem("ram_clear", "cells/test_ram_clear.py"),
    GateItem("ram_fifo", "cells/test_ram_fifo.py"),
    GateItem("packer", "frontend/test_packer.py"),
    GateItem("taps", "frontend/test_taps.py"),
    GateItem("fir", "frontend/test_fir.py"),
    GateItem("line_buffer", "frontend/test_line_buffer.py"),
    GateItem("log", "frontend/test_log.py"),
    GateItem("video_in", "frontend/test_video_in.py"),
    GateItem("frontend", "frontend/test_frontend.py"),
    GateItem("store", "store/test_store.py"),
    GateItem("capture", "store/test_capture.py"),
    GateItem("counters", "control/test_counters.py"),
    GateItem("peek", "control/test_peek.py"),
    GateItem("registers", "control/test_registers.py"),
    GateItem("axi", "control/test_axi.py"),
    GateItem("control", "control/test_control.py"),
    GateItem("job_check", "correlator/test_job_check.py"),
    GateItem("job_plan", "correlator/test_job_plan.py"),
    GateItem("grid", "correlator/test_grid.py"),
    GateItem("fetch", "correlator/test_fetch.py"),
    GateItem("walker", "correlator/test_walker.py"),
    GateItem("sequencer", "correlator/test_sequencer.py"),
    GateItem("align", "correlator/test_align.py"),
    GateItem("operand_array", "array/test_operand_array.py"),
    GateItem("array", "array/test_array.py"),
    GateItem("peak_parts", "peak/test_peak_parts.py"),
    GateItem("peak", "peak/test_peak.py"),
    GateItem("dense_lanes", "dense/test_lanes.py"),
    GateItem("dense_memory", "dense/test_memory.py"),
    GateItem("dense_winner", "dense/test_winner.py"),
    GateItem("dense_engine", "dense/test_engine.py"),
    GateItem("dense_plan", "dense/test_plan.py"),
    GateItem("dense_live", "dense/test_live.py"),
    GateItem("dense_pass", "dense/test_pass.py"),
    GateItem("dense_feed", "dense/test_feed.py"),
    GateItem("dense_check", "dense/test_check.py"),
    GateItem("dense_out", "dense/test_out.py"),
    GateItem("dense_block", "dense/test_block.py"),
    GateItem("dense_wide_lane", "dense/test_wide_lane.py"),
    GateItem("dense_wide_winner", "dense/test_wide_winner.py"),
    GateItem("dense_wide", "dense/test_wide.py", ("test_wide",), "forty lanes of cells take long to build"),
    GateItem("dense_control", "control/test_dense_control.py"),
    GateItem("dense_board", "test_dense_board.py"),
    GateItem("dense_live_board", "test_dense_live.py"),
    GateItem("correlator", "correlator/test_correlator.py"),
    GateItem("board", "test_board.py", ("test_board",), "clocks are gated in the fast simulation build only"),
    GateItem("board_races", "test_board_races.py"),
    GateItem("board_icarus", "", netlist="icarus"),
    GateItem("board_routed", "", netlist="routed"),
)
ELSEWHERE: dict[str, str] = {}
"""Files of `cocotb_tests/` that simulate and are in no item, with the reason."""
