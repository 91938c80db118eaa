# SPDX-License-Identifier: Apache-2.0
"""The wires of a routed netlist: they connect exactly the pins that the netlist connects.

nextpnr writes for each net its wires and the switch (pip) that drives each. A cell's place says which wires its pins
are, so connections can be read off the wires, apart from those that nextpnr lists.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

Cell = Mapping[str, Any]
SWITCH = re.compile(r"X(\d+)/Y(\d+)/(-?\d+)_(-?\d+)_(\w+)->(-?\d+)_(-?\d+)_(\w+)$")
"""A switch: its tile, then tile relative to it and name of the wire before and of the wire after."""
SLICE = re.compile(r"(X\d+/Y\d+)/SLICE([A-D])\.(?:K|FF|RAMW)([01]?)$")
BLOCK = re.compile(r"(X\d+/Y\d+)/(EBR|MULT18_|PIO)(\w)$")
BUFFER = re.compile(r"/(\w?DCC\w+)$")
"""Place of a global network's buffer, whose wires are those of one corner."""
GLOBAL = re.compile(r"/G_\w+$")
"""A wire of a global network: nextpnr lists no switches between its trunks and a tile."""
TRUNK = re.compile(r"/[GL]_(?:VPTX|HPBX)(\d+)$")
"""A trunk or branch of a global network, and the network's number."""
SHARED = "CE", "CLK", "LSR"
"""Pins that both registers of a slice share."""
NEIGHBOURS = {"TRELLIS_COMB": ("F1", "M")}
"""Pins, by kind of cell, that are wires of a neighbour as well: where they are open, a net may have them."""
LISTED = {"TRELLIS_COMB": ("A", "B", "C", "D", "F"), "TRELLIS_FF": ("CE", "DI", "LSR", "M", "Q")}
"""Pins that are looked at, by kind of cell, even where the netlist does not list them."""
PAD = {"I": "PADDO", "O": "JPADDI", "T": "PADDT", "IOLDO": "IOLDO", "IOLTO": "IOLTO"}
"""Wires of a pad's pins."""


def _comb(pin: str, letter: str, half: int, n: int) -> str:
    """The wire of a look-up table's pin, in half `half` of slice `letter`, the n-th of its tile's eight."""
    if pin in ("F1", "OFX"):
        return f"F{n + 1}" if pin == "F1" else f"{('F5', 'FX')[half]}{letter}"
    if pin in ("FCI", "FCO"):
        middle, outer = f"FCI{letter}1", pin + letter
        first, last = pin == "FCI" and letter == "A", pin == "FCO" and letter == "D"
        return middle if (pin == "FCI") == bool(half) else pin if first or last else outer
    if pin in ("WRE", "WCK"):
        return f"{pin}{n // 2}"
    if pin == "WD":
        return f"WD{half}{letter}"
    return f"{pin}{n}" if pin in ("A", "B", "C", "D", "M", "F") else f"{pin}{letter}"


def wire(cell: Cell, pin: str) -> str | None:
    """The wire that a pin is; None for those outside of the device: pads.

    Raises:
        ValueError: if the cell's place is unknown.
    """
    kind, place = cell["type"], cell["attributes"].get("NEXTPNR_BEL", "")
    if (kind, pin) == ("TRELLIS_IO", "B"):
        return None
    if kind == "DCCA" and (found := BUFFER.search(place)):
        return f"X0/Y0/G_{'JCE' if pin == 'CE' else pin}_{found[1]}"
    if found := SLICE.search(place):
        tile, letter, half = found[1], found[2], int(found[3] or 0)
        n = 2 * "ABCD".index(letter) + half
        if kind == "TRELLIS_RAMW":
            name = f"{pin}{letter}" if pin.startswith("W") else f"{pin[0]}{n + int(pin[1])}"
        elif kind == "TRELLIS_FF":
            name = f"{pin}{n // 2 if pin in SHARED else n}"
        else:
            name = _comb(pin, letter, half, n)
        return f"{tile}/{name}_SLICE"
    if found := BLOCK.search(place):
        tile, block, letter = found[1], found[2], found[3]
        if block == "PIO":
            return f"{tile}/{PAD.get(pin, pin)}{letter}_PIO"
        return f"{tile}/J{pin}_{block.rstrip('_')}"
    raise ValueError(f"{kind} has no place that is known: {place!r}")


def _wires(name: str, net: Mapping[str, Any]) -> Iterator[tuple[str, str | None]]:
    """Each wire of a net, and the one before its switch; None where it has no switch.

    Raises:
        ValueError: if a switch drives another wire.
    """
    words = net["attributes"].get("ROUTING", "").strip().split(";")
    for place, switch in zip(words[::3], words[1::3], strict=False):
        if not switch:
            yield place, None
            continue
        found = SWITCH.match(switch)
        if not found:
            raise ValueError(f"net {name}: no such switch: {switch}")
        x, y = int(found[1]), int(found[2])
        before, after = (f"X{x + int(found[k])}/Y{y + int(found[k + 1])}/{found[k + 2]}" for k in (3, 6))
        if after != place:
            raise ValueError(f"net {name}: the switch of {place} drives {after}")
        yield place, before


def _once(name: str, net: Mapping[str, Any]) -> dict[str, str | None]:
    """The `_wires` of a net.

    Raises:
        ValueError: if one comes twice.
    """
    wires: dict[str, str | None] = {}
    for place, before in _wires(name, net):
        if place in wires:
            raise ValueError(f"net {name}: {place} has two switches")
        wires[place] = before
    return wires


def _connected(name: str, wires: Mapping[str, str | None], source: str | None) -> None:
    """Check that each of a net's wires comes from `source`, or from the global network that it drives.

    Raises:
        ValueError: if one does not.
    """
    spread = bool(GLOBAL.search(source or ""))
    known = {place for place, before in wires.items() if before is None}
    begins = {place for place in known if not (spread and TRUNK.search(place))}
    if begins != {source}:
        raise ValueError(f"net {name} begins at {', '.join(sorted(begins)[:3]) or 'no wire'}, not at {source}")
    for end in wires:
        place, way = end, set()
        while place not in known:
            way.add(place)
            before = str(wires[place])
            if spread and GLOBAL.search(before):
                break
            if before not in wires or before in way:
                raise ValueError(f"net {name}: nothing drives {before}, which drives {place}")
            place = before
        known |= way


def _network(name: str, wires: Mapping[str, str | None]) -> str:
    """Number of the one global network whose trunks and branches a net has.

    Raises:
        ValueError: if there is none or another one, too.
    """
    places = (*wires, *filter(None, wires.values()))
    numbers = {found[1] for place in places if (found := TRUNK.search(place))}
    if len(numbers) != 1:
        raise ValueError(f"net {name} is on the global networks {', '.join(sorted(numbers)) or 'none'}, not on one")
    return numbers.pop()


def _exchangeable(cell: Cell) -> tuple[str, ...]:
    """Groups of a look-up table's pins that may change places, as nextpnr then changes the table: those of a memory
    cannot; the first two of a carry cell lead to a table that the others do not."""
    mode = str(cell["parameters"].get("MODE", "LOGIC")).strip()
    groups = {"LOGIC": ("ABCD",), "CCU2": ("AB", "CD")} if cell["type"] == "TRELLIS_COMB" else {}
    return groups.get(mode, ("A", "B", "C", "D"))


def check(module: Mapping[str, Any]) -> tuple[int, int]:
    """Hold the wires of a flat module that nextpnr wrote to the module's connections.

    Returns:
        Number of nets with wires, and of these wires.

    Raises:
        ValueError: if a wire belongs to two nets, a net's wires are not connected to its driver, a pin's wire is not of
            the pin's net, or a look-up table's pins have changed places where its table cannot.
    """
    names = {net["bits"][0]: name for name, net in module["netnames"].items()}
    drivers = {cell["connections"][pin][0]: wire(cell, pin) for cell in module["cells"].values()
               for pin, way in cell["port_directions"].items() if way == "output" and cell["connections"][pin]}
    owner: dict[str, int] = {}
    networks: dict[str, str] = {}
    switches: dict[str, str | None] = {}
    nets = 0
    for name, net in module["netnames"].items():
        bit, wires = net["bits"][0], _once(name, net)
        if not wires:
            continue
        nets += 1
        source = drivers[bit]
        _connected(name, wires, source)
        if source and GLOBAL.search(source):
            number = _network(name, wires)
            if networks.setdefault(number, name) != name:
                raise ValueError(f"global network {number} belongs to {networks[number]} and {name}")
        for place in wires:
            if owner.setdefault(place, bit) != bit:
                raise ValueError(f"{place} belongs to the nets {names[owner[place]]} and {name}")
        switches |= wires
    for name, cell in module["cells"].items():
        if str(cell["parameters"].get("MODE")) != "RAMW_BLOCK":  # what a TRELLIS_RAMW occupies
            _check_pins(name, cell, names, owner, switches)
    return nets, len(owner)


def _check_pins(name: str, cell: Cell, names: Mapping[int, str], owner: Mapping[str, int],
                switches: Mapping[str, str | None]) -> None:
    """Check that each pin's wire is of the pin's net, and of none where it is open and no neighbour's wire as well."""
    tables = cell["type"] in ("TRELLIS_COMB", "TRELLIS_RAMW")
    pins = {pin: net for pin, net in cell["connections"].items()
            if net or pin not in NEIGHBOURS.get(cell["type"], ())}
    pins |= {pin: [] for pin in LISTED.get(cell["type"], ()) if pin not in pins}
    for pin, bits in pins.items():
        place = wire(cell, pin)
        if place is None or (cell["port_directions"].get(pin) == "output" and place not in owner):
            continue  # if something reads an output without wires, that one's pin has no wire either
        if owner.get(place) != (bits[0] if bits else None):
            belongs = names.get(owner.get(place, -1), "no net")
            raise ValueError(f"{name}.{pin} is the wire {place}, which belongs to {belongs}")
        if tables and bits and pin[0] in "ABCD":
            through = str(switches[place]).split("/")[2][0]
            if not any({through, pin[0]} <= set(group) for group in _exchangeable(cell)):
                raise ValueError(f"{name}.{pin} is reached through the slice's pin {through}")
