# SPDX-License-Identifier: Apache-2.0
"""What nextpnr writes after routing, as a netlist for simulators.

nextpnr packs the cells that Yosys made into its own, leaves pins open where the chip has a constant by itself, and
notes other constants as parameters. Here every pin that a cell reads gets its net or its constant, and everything else
goes: places, routes, pins and parameters without a meaning in the cell's mode. The models are `sim/synth/routed.sv`,
`gates.sv` and `cells.sv`. An open pin counts as what nextpnr's bitstream makes of it: see `constant`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from sim.gates.plain import value

Cell = Mapping[str, Any]
HALF = re.compile(r"X\d+/Y\d+/SLICE[A-D]\.K([01])$")
"""nextpnr's name of the place of a look-up table: tile, slice, half of the slice."""
MEMORY_PINS = "WD", "WAD0", "WAD1", "WAD2", "WAD3", "WRE", "WCK"
READ = {
    "TRELLIS_RAMW": tuple(f"{pin}{k}" for k in range(2) for pin in "ABCD"),
    "DCCA": ("CLKI", "CE"),
    "DP16KD": tuple(f"{pin}{side}{k}" for side in "AB" for pin, count in (("AD", 14), ("DI", 18), ("CS", 3))
                    for k in range(count)) + tuple(f"{pin}{side}" for side in "AB"
                                                   for pin in ("CLK", "CE", "WE", "OCE", "RST")),
    "MULT18X18D": tuple(f"{pin}{side}" for side in "AB" for pin in ("SIGNED", "SOURCE"))
                  + tuple(f"{side}{k}" for side in "AB" for k in range(18)),
}
"""Inputs that cells of these kinds always read; of MULT18X18D besides the pins that its parameters name."""
DSP_CONTROLS = tuple(f"{pin}{k}" for pin in ("CLK", "CE", "RST") for k in range(4))
"""Pins of MULT18X18D that parameters name."""
LIKE_ONE = re.compile(r"O?CE[AB]$")
"""Inputs of DP16KD that count as 1 where they are open and no parameter says otherwise; all others count as 0."""
INVERTED = re.compile(r"(CLK|WE|RST|O?CE|CS)[AB]\d?$")
"""Inputs of DP16KD that are 1 where they are open, with an inverter behind them for a 0; the others take either."""
FIRST = 2
"""The lowest number of a net: 0 and 1 are constants."""
KEPT = {
    "TRELLIS_COMB": ("MODE", "INITVAL", "CCU2_INJECT1", "WREMUX", "WCKMUX"),
    "TRELLIS_FF": ("GSR", "CEMUX", "CLKMUX", "LSRMUX", "LSRONMUX", "SRMODE", "REGSET", "LSRMODE", "SD"),
    "DP16KD": ("DATA_WIDTH_A", "DATA_WIDTH_B", "REGMODE_A", "REGMODE_B", "RESETMODE", "ASYNC_RESET_RELEASE",
               "CSDECODE_A", "CSDECODE_B", "WRITEMODE_A", "WRITEMODE_B", "GSR"),
    "MULT18X18D": (*(f"REG_{register}_{pin}" for register in ("INPUTA", "INPUTB", "PIPELINE", "OUTPUT")
                     for pin in ("CLK", "CE", "RST")), "GSR", "RESETMODE"),
    "TRELLIS_RAMW": (), "TRELLIS_IO": ("DIR", "DATAMUX_ODDR", "DATAMUX_MDDR"), "DCCA": (),
}
"""Parameters of the models."""


def _net(cell: Cell, pin: str) -> bool:
    return bool(cell["connections"].get(pin))


def _table_may_be_high(cell: Cell) -> bool:
    """Whether a half of a carry cell's table has a 1 at an address that its nets can reach; open pins are high."""
    table, fixed = int(value(cell, "INITVAL"), 2), sum(1 << k for k, pin in enumerate("ABCD") if not _net(cell, pin))
    return any(table >> address & 1 for address in range(16) if address & fixed == fixed)


def inputs(cell: Cell) -> list[str]:
    """The inputs that a cell reads in its mode.

    Raises:
        ValueError: if there is no model of the cell.
    """
    kind = cell["type"]
    if kind == "TRELLIS_COMB":
        mode = value(cell, "MODE", "LOGIC")
        pins = [*"ABCD", *{"CCU2": ("FCI",), "DPRAM": MEMORY_PINS}.get(mode, ())]
        if _net(cell, "OFX"):
            pins += ["M", "F1"] if half(cell) == 0 else ["M", "FXA", "FXB"]
        return pins
    if kind == "TRELLIS_FF":
        return ["CLK", "LSR", "DI" if value(cell, "SD", "0") == "1" else "M",
                *(["CE"] if value(cell, "CEMUX", "1") in ("CE", "INV") else [])]
    if kind == "TRELLIS_IO":
        return ["B"] if value(cell, "DIR") == "INPUT" else ["I"]
    if kind not in READ:
        raise ValueError(f"cell {kind} is not modelled")
    named = sorted({value(cell, name) for name in KEPT[kind]} & set(DSP_CONTROLS)) if kind == "MULT18X18D" else []
    return [*READ[kind], *named]


def half(cell: Cell) -> int:
    """The half of its slice in which a look-up table lies: in the first one OFX chooses between F and F1, in the second
    one between FXA and FXB.

    Raises:
        ValueError: if the cell has no such place.
    """
    place = HALF.search(cell["attributes"].get("NEXTPNR_BEL", ""))
    if not place:
        raise ValueError(f"a look-up table has no place: {cell['attributes']}")
    return int(place[1])


def constant(cell: Cell, pin: str) -> str:
    """What an open input counts as: `0`, `1`, or `x` where only what nothing reads depends on it.

    The table of a look-up table is written without its open pins, as if they were low; that of a carry cell keeps
    them, and the chip ties them high. A register without a net at LSR is never reset. The inputs of block RAMs and
    multipliers have their constants as parameters. A memory's data pin is open where that bit of its words is unused.

    Raises:
        ValueError: if the cell's outputs depend on an input that nothing determines.
    """
    kind, mux = cell["type"], value(cell, f"{pin}MUX")
    if kind == "TRELLIS_COMB" and pin in "ABCD" and value(cell, "MODE", "LOGIC") != "DPRAM":
        return "1" if value(cell, "MODE", "LOGIC") == "CCU2" else "0"
    if kind == "TRELLIS_COMB" and pin == "FCI" and not _table_may_be_high(cell) and not _net(cell, "F"):
        return "0"
    if kind == "TRELLIS_FF" and pin == "LSR":
        return "1" if mux == "INV" else "0"
    if kind == "DP16KD":
        return str(int(mux == (pin if INVERTED.match(pin) else "1") or (not mux and bool(LIKE_ONE.match(pin)))))
    if kind == "MULT18X18D" and re.match(r"[AB]\d", pin):
        return str(int(mux == "1"))
    if kind == "DCCA" and pin == "CE":
        return "1"
    if kind == "TRELLIS_RAMW" and pin.endswith("1"):
        return "x"
    raise ValueError(f"{kind} reads its pin {pin}, which is open: {cell['parameters']}")


def _parameters(cell: Cell) -> dict[str, str]:
    """The parameters that its model has.

    Raises:
        ValueError: if another one says more than which constant an open pin has.
    """
    kind = cell["type"]
    kept = {name: text for name, text in cell["parameters"].items() if name in KEPT[kind]}
    for name in cell["parameters"].keys() - kept.keys():
        pin = name.removesuffix("MUX")
        if not name.endswith("MUX") or _net(cell, pin):
            raise ValueError(f"{kind} has the parameter {name}, which is not modelled: {cell['parameters'][name]}")
    if kind == "TRELLIS_COMB":
        kept["MUX"] = "F1" if half(cell) == 0 else "FX"
    return kept


def closed(cell: Cell) -> dict[str, Any]:
    """A cell of nextpnr's for its model: with constants at its open inputs, without anything that the model has not.

    Raises:
        ValueError: if the cell, its mode or a constant is not modelled.
    """
    kind, nets, ways = cell["type"], {}, {}
    for pin in inputs(cell):
        bits = cell["connections"].get(pin) or [constant(cell, pin)]
        nets[pin], ways[pin] = bits, "input"
    for pin, way in cell["port_directions"].items():
        if way != "input" and pin not in nets and _net(cell, pin):
            nets[pin], ways[pin] = cell["connections"][pin], "output"
    parameters = _parameters(cell)
    if kind == "TRELLIS_IO":
        direction = parameters.pop("DIR").strip()
        if (direction not in ("INPUT", "OUTPUT") or any(_net(cell, pin) for pin in ("T", "IOLDO", "IOLTO"))
                or set(parameters.values()) - {"PADDO"}):
            raise ValueError(f"a pin is neither a plain input nor a plain output: {cell['parameters']}")
        kind, parameters = f"TRELLIS_IO_{direction}", {}
    return {"hide_name": 0, "type": kind, "parameters": parameters, "attributes": {}, "port_directions": ways,
            "connections": nets}


def restored(module: Mapping[str, Any], before: Mapping[str, Any]) -> dict[str, Any]:
    """A module with ports and names of nets as in the netlist that nextpnr took.

    nextpnr keeps one name of a net that has several; the net outside of a pin has the port's name.

    Args:
        module: a `closed_module`.
        before: the flat module that nextpnr took.

    Returns:
        The module; a name of a net that it has no longer has the bit `x`.

    Raises:
        ValueError: if a bit of a port is no pin.
    """
    aliases: dict[int, list[str]] = {}
    for name, net in before["netnames"].items():
        for k, bit in enumerate(net["bits"]):
            if isinstance(bit, int):
                aliases.setdefault(bit, []).append(_bit_name(name, net, k))
    now = {name: net["bits"][0] for name, net in module["netnames"].items()}
    numbers = {bit: next((now[name] for name in names if name in now), "x") for bit, names in aliases.items()}
    pins = {cell["connections"]["B"][0] for cell in module["cells"].values() if "B" in cell["connections"]}
    ports = {name: {**port, "bits": [now.get(_bit_name(name, port, k)) for k in range(len(port["bits"]))]}
             for name, port in before["ports"].items()}
    for name, port in ports.items():
        if set(port["bits"]) - pins:
            raise ValueError(f"a bit of the port {name} is no pin")
    names = {name: {**net, "bits": [numbers.get(bit, bit) for bit in net["bits"]]}
             for name, net in before["netnames"].items()}
    return {**module, "ports": ports, "netnames": names}


def _bit_name(name: str, net: Mapping[str, Any], k: int) -> str:
    """nextpnr's name of bit k of a net or port."""
    return f"{name}[{net.get('offset', 0) + k}]" if len(net["bits"]) > 1 else name


def flipped(module: Mapping[str, Any], port: str, high: Sequence[str]) -> dict[str, Any]:
    """The module with one wrong bit in the look-up table before the register that drives an output.

    It is the bit at rest: that with all the table's inputs low, but for `high`.

    Args:
        module: `restored`.
        port: the output's name, one bit.
        high: names of input ports, of one bit each, that are high at rest.

    Raises:
        ValueError: if there is no look-up table.
    """
    cells = module["cells"]
    drivers = {cell["connections"][pin][0]: name for name, cell in cells.items()
               for pin, way in cell["port_directions"].items() if way == "output"}
    name = drivers.get(module["ports"][port]["bits"][0], "")
    for pins in ("I",), ("DI", "M"):
        nets = cells[name]["connections"] if name else {}
        name = next((drivers[nets[pin][0]] for pin in pins if pin in nets), "")
    if not name or cells[name]["type"] != "TRELLIS_COMB":
        raise ValueError(f"no look-up table drives the register of {port}")
    nets = cells[name]["connections"]
    ones = {"1", *(cell["connections"]["O"][0] for cell in cells.values() if cell["type"] == "TRELLIS_IO_INPUT"
                   and cell["connections"]["B"][0] in [module["ports"][each]["bits"][0] for each in high]
                   and "O" in cell["connections"])}
    address = sum(1 << k for k, pin in enumerate("ABCD") if nets[pin][0] in ones)
    table = int(value(cells[name], "INITVAL"), 2) ^ 1 << address
    wrong = {**cells[name], "parameters": {**cells[name]["parameters"], "INITVAL": f"{table:016b}"}}
    return {**module, "cells": {**cells, name: wrong}}


def closed_module(module: Mapping[str, Any]) -> dict[str, Any]:
    """A module as nextpnr wrote it, its cells `closed`, its nets with their names and numbered without gaps.

    Raises:
        ValueError: if a cell, its mode or a constant is not modelled.
    """
    numbers: dict[Any, Any] = {}

    def net(bits: Sequence[Any]) -> list[Any]:
        return [numbers.setdefault(bit, len(numbers) + FIRST) if isinstance(bit, int) else bit for bit in bits]

    cells = {name: closed(cell) for name, cell in module["cells"].items()
             if value(cell, "MODE") != "RAMW_BLOCK"}  # what a TRELLIS_RAMW occupies
    for cell in cells.values():
        cell["connections"] = {pin: net(bits) for pin, bits in cell["connections"].items()}
    ports, names = ({name: {**each, "bits": net(each["bits"]), "attributes": {}}
                     for name, each in module[group].items()} for group in ("ports", "netnames"))
    return {"attributes": {}, "ports": ports, "cells": cells, "netnames": names}
