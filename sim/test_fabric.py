"""Loads of global networks."""

import json
from pathlib import Path
from typing import Any

from sim.fabric import move_in


def _cell(kind: str, out: str, **pins: int | str) -> dict[str, Any]:
    return {"type": kind, "connections": {pin: [bit] for pin, bit in pins.items()},
            "port_directions": {pin: "output" if pin == out else "input" for pin in pins}}


def test_only_pins_of_registers_stay_on_a_network(tmp_path: Path) -> None:
    cells = {"source": _cell("TRELLIS_FF", "Q", CLK=2, DI=3, Q=4),
             "net": _cell("DCCA", "CLKO", CLKI=4, CE="1", CLKO=5),
             "reset": _cell("TRELLIS_FF", "Q", CLK=2, LSR=5, DI=6, Q=7),
             "lut": _cell("LUT4", "Z", A=5, B=7, C="0", Z=6),
             "data": _cell("TRELLIS_FF", "Q", CLK=2, LSR="0", DI=5, Q=8)}
    path = tmp_path / "netlist.json"
    path.write_text(json.dumps({"modules": {"top": {"cells": cells}}}))
    assert move_in(path) == 2
    after = json.loads(path.read_text())["modules"]["top"]["cells"]
    assert after["reset"] == cells["reset"] and after["net"] == cells["net"] and after["source"] == cells["source"]
    assert after["lut"]["connections"] == {"A": [4], "B": [7], "C": ["0"], "Z": [6]}
    assert after["data"]["connections"]["DI"] == [4]
