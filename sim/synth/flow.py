# SPDX-License-Identifier: Apache-2.0
"""Synthesis for the Lattice ECP5: Yosys (slang front end), then place and route by nextpnr with several seeds.

`python -m sim.synth [--config full|tiny|dense|tiny_dense]` writes `out/synth/report.json` (for others than `full`,
`out/synth/<config>/report.json`):
    fmax_mhz    median over the seeds of the routed clock, but no more than the block RAM allows
    routed_mhz  routed clock of each seed
    router      nextpnr's router that routed each seed
    lut4, ff, ebr, dsp  of the whole board and of each block; `share` of the device's
Block RAMs and multipliers of the board get their sites from `sim.synth.floorplan`.
`--top MODULE` (with `-G NAME=VALUE`) takes one module alone, its pins unplaced. `--paths NS` does not place and route:
it prints the paths that `sim.synth.paths` estimates to be longer. `--placed NS` places with the first seed and prints
the same, estimated with the cells' places. `--floorplan STARTS` searches for sites and keeps the best.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from golden.params import CONFIGS
from sim.synth.floorplan import constrain, keep
from sim.synth.nextpnr import critical_path, place, route, target_of
from sim.synth.paths import load, ranking
from sim.synth.yosys import AVAILABLE, write_netlist
from sim.toolchain import SYNTHESIS, top_of

FLOORPLANS = Path(__file__).with_name("floorplans")
DEVICE = "LFE5U-85F-6"
EBR_LIMIT_MHZ = 212.0
"""Highest clock of a block RAM at speed grade 6, MHz, which nextpnr does not check."""


def _floorplan(top: str, config: str, folder: Path) -> None:
    if top == top_of(config):
        print("floorplan: block RAMs and multipliers", flush=True)
        constrain(folder / "netlist.json", FLOORPLANS / f"{config}.json")


def synthesise(top: str, config: str, parameters: Sequence[str], seeds: Sequence[int], folder: Path) -> dict[str, Any]:
    """Run the whole flow and write `report.json` into `folder`; returns its content."""
    blocks = write_netlist(top, config, parameters, folder)
    whole = blocks.pop("whole")
    _floorplan(top, config, folder)
    routed, routers, paths = {}, {}, {}
    print(f"nextpnr: seeds {', '.join(map(str, seeds))}", flush=True)
    with ThreadPoolExecutor(os.cpu_count()) as workers:
        reports = workers.map(lambda seed: route(folder, seed, top == top_of(config), target_of(config)), seeds)
        for seed, report in zip(seeds, reports, strict=True):
            routed[seed] = min(clock["achieved"] for clock in report["fmax"].values())
            routers[str(seed)], paths[seed] = report["router"], critical_path(report)
            print(f"  seed {seed}: {routed[seed]:.1f} MHz", flush=True)
    median = statistics.median(routed.values())
    result = {
        "top": top, "config": config, "device": DEVICE,
        "fmax_mhz": round(min(median, EBR_LIMIT_MHZ if whole["ebr"] else median), 1),
        "median_routed_mhz": round(median, 1), "ebr_limit_mhz": EBR_LIMIT_MHZ,
        "routed_mhz": {str(seed): round(mhz, 1) for seed, mhz in routed.items()}, "router": routers,
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
    parser.add_argument("--top", help="one module instead of the whole board")
    parser.add_argument("-G", dest="parameters", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    stop = parser.add_mutually_exclusive_group()
    stop.add_argument("--paths", type=float, metavar="NS", help="print paths estimated to be longer, and stop there")
    stop.add_argument("--placed", type=float, metavar="NS", help="place, print paths estimated to be longer, and stop")
    stop.add_argument("--floorplan", type=int, metavar="STARTS", help="keep the best of so many floorplans, and stop")
    args = parser.parse_args()
    board = top_of(args.config)
    args.top = args.top or board
    if args.floorplan is not None and args.top != board:
        parser.error("--floorplan is for the whole board: leave --top out")
    folder = SYNTHESIS
    if args.top != board:
        folder = SYNTHESIS / args.top
    elif args.config != "full":
        folder = SYNTHESIS / args.config
    if args.floorplan is not None:
        write_netlist(args.top, args.config, args.parameters, folder)
        keep(folder / "netlist.json", FLOORPLANS / f"{args.config}.json", args.floorplan)
        return 0
    if args.paths is not None or args.placed is not None:
        write_netlist(args.top, args.config, args.parameters, folder)
        placed = None
        if args.placed is not None:
            _floorplan(args.top, args.config, folder)
            print(f"nextpnr: placing, seed {args.seeds[0]}", flush=True)
            placed = place(folder, args.seeds[0], args.top == board, target_of(args.config))
        over = args.paths if placed is None else args.placed
        print("\n".join(ranking(load(folder / "netlist.json", placed), over)))
        return 0
    result = synthesise(args.top, args.config, args.parameters, args.seeds, folder)
    print(f"{args.top}: {result['fmax_mhz']} MHz, " + ", ".join(f"{result[name]} {name}" for name in AVAILABLE)
          + f"; {folder / 'report.json'}")
    return int(any(result[name] > limit for name, limit in AVAILABLE.items()))
