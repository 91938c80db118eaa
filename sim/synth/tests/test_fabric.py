# SPDX-License-Identifier: Apache-2.0
"""Loads of global networks."""

import json
from pathlib import Path
from typing import Any

import pytest

from sim.synth.fabric import move_in


def _cell(kind: str, out: str, **pins: int | str) -> dict[str, Any]:
    return {"type": kind, "connections": {pin: [bit] for pin, bit in pins.items()},
            "port_directions": {pin: "output" if pin == out else "input" for pin in pins}}


def _moved(path: Path, cells: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    path.write_text(json.dumps({"modules": {"top": {"cells": cells, "netnames": {}}}}))
    return move_in(path), json.loads(path.read_text())["modules"]["top"]["cells"]


def test_only_pins_of_registers_stay_on_a_network(tmp_path: Path) -> None:
    """Look-up tables and data pins read a copy of the register, one copy for each block."""
    cells = {"source": _cell("TRELLIS_FF", "Q", CLK=2, DI=3, Q=4),
             "net": _cell("DCCA", "CLKO", CLKI=4, CE="1", CLKO=5),
             "a.b.reset": _cell("TRELLIS_FF", "Q", CLK=2, LSR=5, DI=6, Q=7),
             "a.b.lut": _cell("LUT4", "Z", A=5, B=7, C="0", Z=6),
             "a.b.c.lut": _cell("LUT4", "Z", A=5, B=7, C="0", Z=9),
             "a.d.data": _cell("TRELLIS_FF", "Q", CLK=2, LSR="0", DI=5, Q=8)}
    moved, after = _moved(tmp_path / "netlist.json", cells)
    assert moved == 3
    assert all(after[name] == cells[name] for name in ("source", "net", "a.b.reset"))
    first, second = after["a.b.fabric0"], after["a.d.fabric1"]
    assert {name: first["connections"][name] for name in ("CLK", "DI")} == {"CLK": [2], "DI": [3]}
    outputs = [copy["connections"]["Q"][0] for copy in (first, second)]
    assert len({*outputs, *range(10)}) == 12
    assert after["a.b.lut"]["connections"] == {"A": outputs[:1], "B": [7], "C": ["0"], "Z": [6]}
    assert after["a.b.c.lut"]["connections"]["A"] == outputs[:1]
    assert after["a.d.data"]["connections"]["DI"] == outputs[1:]


def test_a_copy_has_a_register_of_its_own_before_it(tmp_path: Path) -> None:
    cells = {"before": _cell("TRELLIS_FF", "Q", CLK=2, DI=10, Q=3),
             "source": _cell("TRELLIS_FF", "Q", CLK=2, DI=3, Q=4),
             "net": _cell("DCCA", "CLKO", CLKI=4, CE="1", CLKO=5),
             "a.b.lut": _cell("LUT4", "Z", A=5, B=7, C="0", Z=6),
             "a.d.data": _cell("TRELLIS_FF", "Q", CLK=2, LSR="0", DI=5, Q=8)}
    moved, after = _moved(tmp_path / "netlist.json", cells)
    assert moved == 2
    for load, hop, copy in (("a.b.lut", "a.b.fabric0", "a.b.fabric1"), ("a.d.data", "a.d.fabric2", "a.d.fabric3")):
        assert after[hop]["connections"]["DI"] == [10]
        assert after[copy]["connections"]["DI"] == after[hop]["connections"]["Q"]
        assert after[copy]["connections"]["Q"] in after[load]["connections"].values()


def test_a_network_without_a_register_is_refused(tmp_path: Path) -> None:
    cells = {"net": _cell("DCCA", "CLKO", CLKI=4, CE="1", CLKO=5), "a.lut": _cell("LUT4", "Z", A=5, Z=6)}
    with pytest.raises(ValueError, match="no register"):
        _moved(tmp_path / "netlist.json", cells)
