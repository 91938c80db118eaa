# SPDX-License-Identifier: Apache-2.0
"""Ranks all paths of a netlist between registers by a delay model; nextpnr shows only one.

Cells have the delays of speed grade 6. Before placement only a wire's fan-out is known: `wire` is a guess that fits
small blocks, and reveals paths of too much logic. After it `distance` is nextpnr's own estimate, and reveals wires that
are too long.
"""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sim.synth.fabric import GLOBAL
from sim.synth.netlist import flat

CLOCK_TO_OUT = {"TRELLIS_FF": 0.52, "DP16KD": 5.6, "PDPW16KD": 5.6, "MULT18X18D": 4.0}
"""Nanoseconds from the clock to a register's output, for blocks without an output register."""
WITH_OUTPUT_REGISTER = 1.0
SETUP = {"TRELLIS_FF": 0.0, "MULT18X18D": 0.5}
"""Nanoseconds before the clock; 0.4 for block RAM and distributed RAM."""
MUXES = "PFUMX", "L6MUX21"
NUMBER = re.compile(r"\d+")
TILE = re.compile(r"X(\d+)/Y(\d+)/")
PACKED = ("", "$COMB0", "$CCU2_COMB0", "$DPRAM_COMB0", "$RAMW_SLICE")
"""Suffixes that nextpnr adds to the name of a cell, or to that of the first cell that it makes of it."""

Place = tuple[int, int]
"""Column and row of a tile."""


def wire(fan_out: int) -> float:
    """Estimated nanoseconds of a wire with `fan_out` loads."""
    return 0.65 if fan_out < 2 else 0.75 + 0.22 * math.log2(fan_out)


def distance(start: Place, end: Place) -> float:
    """Nanoseconds of a wire between two tiles, as nextpnr estimates them."""
    away = [abs(a - b) for a, b in zip(start, end, strict=True)]
    return 0.08 * (6 + sum(max(d - 5, 0) + 2 * min(d, 5) for d in away))


def through(kind: str, pin: str, out: str) -> float:
    """Nanoseconds from an input pin of a cell without a register to an output pin."""
    if kind == GLOBAL:
        return 0.0  # nextpnr counts the network as immediate
    if kind in MUXES:
        return 0.25 if pin in ("C0", "SD") else 0.2
    if kind == "CCU2C":
        return 0.07 if (pin, out) == ("CIN", "COUT") else 0.45
    return 0.24


@dataclass(frozen=True)
class Timing:
    """A path between registers: nanoseconds, nets from its first register's output on, cell and pin it ends at."""

    time: float
    nets: tuple[int, ...]
    cell: str
    pin: str


@dataclass
class Netlist:
    """A flat netlist as Yosys writes it: `cells` and `netnames` of one module; `places` of cells, once placed."""

    cells: Mapping[str, Any]
    netnames: Mapping[str, Any]
    places: Mapping[str, Place] = field(default_factory=dict)
    names: dict[int, str] = field(init=False, default_factory=dict)
    drivers: dict[int, tuple[str, str]] = field(init=False, default_factory=dict)
    loads: Counter[int] = field(init=False, default_factory=Counter)
    _latest: dict[int, tuple[float, int | None]] = field(init=False, default_factory=dict)
    _tiles: dict[str, Place | None] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        for name, net in self.netnames.items():
            for k, bit in enumerate(net["bits"]):
                called = f"{name}[{k}]" if len(net["bits"]) > 1 else name
                old = self.names.get(bit)
                if old is None or (called.startswith("$"), len(called)) < (old.startswith("$"), len(old)):
                    self.names[bit] = called
        for name in self.cells:
            for pin, bit, drives in self._pins(name):
                if drives:
                    self.drivers[bit] = name, pin
                else:
                    self.loads[bit] += 1

    def _pins(self, name: str) -> Iterator[tuple[str, int, bool]]:
        """Pin, net and whether the pin drives it, of all pins of a cell that are not tied."""
        cell = self.cells[name]
        for pin, bits in cell["connections"].items():
            for bit in bits:
                if isinstance(bit, int):
                    yield pin, bit, cell["port_directions"][pin] == "output"

    def _wire(self, bit: int, kind: str, pin: str, name: str) -> float:
        driver = self.drivers.get(bit, ("", ""))[0]
        if driver and self.cells[driver]["type"] == GLOBAL:
            return 0.0
        if pin == "CIN" if kind == "CCU2C" else kind in MUXES and pin in ("ALUT", "BLUT", "D0", "D1"):
            return 0.0
        start, end = self.place(driver), self.place(name)
        if start is None or end is None:
            return wire(self.loads[bit])
        return 0.0 if pin == "DI" and start == end else distance(start, end)

    def place(self, name: str) -> Place | None:
        """Tile of a cell, if it is placed; a multiplexer between look-up tables has the tile of one of them."""
        if name not in self._tiles:
            tile = next((self.places[name + end] for end in PACKED if name + end in self.places), None)
            if tile is None and self.places and name and self.cells[name]["type"] in MUXES:
                pins = self.cells[name]["connections"]
                inside = pins["ALUT" if "ALUT" in pins else "D0"][0]
                tile = self.place(self.drivers.get(inside, ("", ""))[0])
            self._tiles[name] = tile
        return self._tiles[name]

    def arrival(self, bit: int) -> tuple[float, int | None]:
        """Nanoseconds after the clock at which a net settles, and the net that decides it (None: register or port)."""
        if bit in self._latest:
            return self._latest[bit]
        stack = [bit]
        while stack:
            at = stack[-1]
            name, out = self.drivers.get(at, ("", ""))
            cell = self.cells.get(name)
            if cell is None or cell["type"] in CLOCK_TO_OUT:
                self._latest[at] = (self._leaves(cell) if cell else 0.0), None
                stack.pop()
                continue
            kind = cell["type"]
            ins = [(pin, b) for pin, b, drives in self._pins(name)
                   if not drives and not (kind == "TRELLIS_DPR16X4" and not pin.startswith("RAD"))]
            waiting = [b for _, b in ins if b not in self._latest and b not in stack]
            if waiting:
                stack.extend(waiting)
                continue
            times = [(self._latest.get(b, (0.0, None))[0] + self._wire(b, kind, pin, name) + through(kind, pin, out), b)
                     for pin, b in ins]
            self._latest[at] = max(times, default=(0.0, None))
            stack.pop()
        return self._latest[bit]

    @staticmethod
    def _leaves(cell: Mapping[str, Any]) -> float:
        settings = cell.get("parameters", {})
        registered = (any("OUTREG" in str(settings.get(f"REGMODE_{port}", "")) for port in "AB")
                      or settings.get("REG_OUTPUT_CLK", "NONE") != "NONE")
        return WITH_OUTPUT_REGISTER if registered else CLOCK_TO_OUT[cell["type"]]

    def paths(self) -> list[Timing]:
        """The slowest path to every pin of every register, the slowest first."""
        found = []
        for name, cell in self.cells.items():
            kind = cell["type"]
            if kind not in CLOCK_TO_OUT and kind != "TRELLIS_DPR16X4":
                continue
            for pin, bit, drives in self._pins(name):
                if drives or pin.startswith(("CLK", "RAD")) or pin == "WCK":
                    continue
                nets = [bit]
                time, before = self.arrival(bit)
                while before is not None:
                    nets.append(before)
                    before = self.arrival(before)[1]
                time += self._wire(bit, kind, pin, name) + SETUP.get(kind, 0.4)
                found.append(Timing(time, tuple(nets[::-1]), name, pin))
        return sorted(found, key=lambda path: -path.time)

    def start(self, path: Timing) -> str:
        """Name of the net a path starts at."""
        return self.names.get(path.nets[0], "?")

    def end(self, path: Timing) -> str:
        """Name of the end of a path: a flip-flop's output net, or a block; and the pin."""
        connections = self.cells[path.cell]["connections"]
        name = path.cell if "Q" not in connections else self.names.get(connections["Q"][0], path.cell)
        return f"{name}.{path.pin}"

    def hops(self, path: Timing) -> str:
        """The cells along a path, each with its fan-out and, once placed, its tile; the tile of its end."""
        hops = []
        for bit in path.nets:
            name = self.drivers.get(bit, ("", ""))[0]
            kind = self.cells[name]["type"] if name else "port"
            hops.append(f"{kind}({self.loads[bit]}){_at(self.place(name))}")
        return " > ".join(hops) + _at(self.place(path.cell), " > ")


def _at(place: Place | None, before: str = "") -> str:
    return f"{before}@{place[0]},{place[1]}" if place else ""


def load(path: Path, placed: Path | None = None) -> Netlist:
    """Read a netlist that `sim.synth` wrote, and the places that nextpnr gave its cells (its own `--write`)."""
    places = {}
    if placed is not None:
        for name, cell in flat(json.loads(placed.read_text()))["cells"].items():
            if tile := TILE.match(cell["attributes"].get("NEXTPNR_BEL", "")):
                places[name] = int(tile[1]), int(tile[2])
    module = flat(json.loads(path.read_text()))
    return Netlist(module["cells"], module["netnames"], places)


def ranking(netlist: Netlist, over: float) -> list[str]:
    """Lines: how many ends are over how much, then a pair of lines for each pair of modules, the slowest first."""
    paths = netlist.paths()
    lines = [f"{len(paths)} ends; over 6.67 ns {sum(p.time > 6.67 for p in paths)}, over {over} ns "
             f"{sum(p.time > over for p in paths)}"]

    def module(name: str) -> str:
        return NUMBER.sub("#", name.rsplit(".", 1)[0])

    groups: dict[tuple[str, str], list[Timing]] = {}
    for path in paths:
        if path.time <= over:
            break
        ends = module(netlist.start(path)), module(netlist.end(path).rsplit(".", 1)[0])
        groups.setdefault(ends, []).append(path)
    for members in groups.values():
        worst = members[0]
        lines.append(f"{worst.time:5.2f} ns, {len(members)} ends: {netlist.start(worst)} -> {netlist.end(worst)}")
        lines.append(f"         {netlist.hops(worst)}")
    return lines
