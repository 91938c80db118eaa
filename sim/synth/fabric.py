# SPDX-License-Identifier: Apache-2.0
"""Gives loads that a global network does not reach a driver of their own.

The networks of an ECP5 reach registers' clock, reset and enable pins. nextpnr also routes one to a look-up table, on
fabric wires that it then reserves, which may leave another net unroutable. So all other loads of a network here read a
copy of the register that drives it, behind a copy of the register before that: each block has its own two copies, as
blocks are far apart.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any

from sim.synth.netlist import flat

GLOBAL = "DCCA"
"""Cell that drives a global network."""
REACHED = {"TRELLIS_FF": ("CLK", "LSR", "CE"), "DP16KD": ("CLKA", "CLKB"), "MULT18X18D": ("CLK0",),
           "TRELLIS_DPR16X4": ("WCK",)}
"""Pins that a network reaches, by kind of cell."""


def move(module: Mapping[str, Any]) -> int:
    """Connect loads that no network reaches to copies of the register that drives theirs and of the one before it.

    Args:
        module: a flat netlist, as Yosys writes it; its cells' connections are changed, copies of registers added.

    Returns:
        Number of pins moved.

    Raises:
        ValueError: a network with such loads is not driven by a register.
    """
    cells = module["cells"]
    registers = {cell["connections"]["Q"][0]: cell for cell in cells.values() if cell["type"] == "TRELLIS_FF"}
    drivers = {cell["connections"]["CLKO"][0]: cell["connections"]["CLKI"][0] for cell in cells.values()
               if cell["type"] == GLOBAL}
    free = max(bit for cell in cells.values() for bits in cell["connections"].values() for bit in bits
               if isinstance(bit, int))
    copies: dict[tuple[int, str], int] = {}
    new: dict[str, Any] = {}
    moved = 0
    for name, cell in cells.items():
        block = ".".join(name.split(".")[:2])
        for pin, bits in cell["connections"].items():
            if cell["port_directions"][pin] == "output" or pin in REACHED.get(cell["type"], ()):
                continue
            for place, bit in enumerate(bits):
                if bit not in drivers:
                    continue
                if drivers[bit] not in registers:
                    raise ValueError(f"{name}.{pin} reads a global network that no register drives")
                if (bit, block) not in copies:
                    copy = deepcopy(registers[drivers[bit]])
                    chain = [copy]
                    if copy["connections"]["DI"][0] in registers:
                        chain.insert(0, deepcopy(registers[copy["connections"]["DI"][0]]))
                        copy["connections"]["DI"] = [free + 1]
                    for each in chain:
                        free += 1
                        each["connections"]["Q"] = [free]
                        called = f"{block}.fabric{len(new)}"
                        new[called] = each
                        module["netnames"][called] = {"hide_name": 0, "bits": [free], "attributes": {}}
                    copies[bit, block] = free
                bits[place] = copies[bit, block]
                moved += 1
    cells.update(new)
    return moved


def move_in(path: Path) -> int:
    """`move` in the netlist at `path`, as `sim.synth` wrote it."""
    design = json.loads(path.read_text())
    moved = move(flat(design))
    path.write_text(json.dumps(design))
    return moved
