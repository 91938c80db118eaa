"""Loads of a global network that only fabric can reach.

The networks of an ECP5 lead to registers' clock, reset and enable pins. nextpnr leads one to a look-up table too, on
fabric wires that it then keeps from all others, which may leave another net without a way. So whatever else reads a
network here reads the register that drives it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

GLOBAL = "DCCA"
"""Cell that drives a global network."""
REACHED = {"TRELLIS_FF": ("CLK", "LSR", "CE"), "DP16KD": ("CLKA", "CLKB"), "MULT18X18D": ("CLK0",),
           "TRELLIS_DPR16X4": ("WCK",)}
"""Pins that a network leads to, by kind of cell."""


def move(cells: Mapping[str, Mapping[str, Any]]) -> int:
    """Let loads that no network reaches read what drives theirs.

    Args:
        cells: of a flat netlist, as Yosys writes it; their connections are changed.

    Returns:
        Number of pins moved.
    """
    drivers = {cell["connections"]["CLKO"][0]: cell["connections"]["CLKI"][0] for cell in cells.values()
               if cell["type"] == GLOBAL}
    moved = 0
    for cell in cells.values():
        for pin, bits in cell["connections"].items():
            if cell["port_directions"][pin] == "output" or pin in REACHED.get(cell["type"], ()):
                continue
            new = [drivers.get(bit, bit) for bit in bits]
            moved += sum(a != b for a, b in zip(bits, new, strict=True))
            cell["connections"][pin] = new
    return moved


def move_in(path: Path) -> int:
    """`move` in the netlist at `path`, as `sim.synth` wrote it."""
    design = json.loads(path.read_text())
    moved = move(max((module["cells"] for module in design["modules"].values()), key=len))
    path.write_text(json.dumps(design))
    return moved
