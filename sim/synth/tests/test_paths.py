# SPDX-License-Identifier: Apache-2.0
"""The estimate of paths, on netlists small enough to add up by hand."""

from __future__ import annotations

from typing import Any

import pytest

from sim.synth.paths import Netlist, distance, ranking, wire

OUTS = "Q", "Z", "COUT", "S0", "DOA0"


def _cell(kind: str, parameters: dict[str, str] | None = None, **pins: int) -> dict[str, Any]:
    return {"type": kind, "parameters": parameters or {}, "connections": {pin: [bit] for pin, bit in pins.items()},
            "port_directions": {pin: "output" if pin in OUTS else "input" for pin in pins}}


def _netlist(**cells: dict[str, Any]) -> Netlist:
    return Netlist(cells, {"u_a.start_q": {"bits": [2]}, "u_b.end_q": {"bits": [9]}, "$1": {"bits": [2]}})


def test_a_path_adds_up_cells_and_wires_and_is_named() -> None:
    netlist = _netlist(start=_cell("TRELLIS_FF", CLK=1, Q=2, DI=9), one=_cell("LUT4", A=2, B=1, Z=3),
                       two=_cell("LUT4", A=3, B=2, Z=4), end=_cell("TRELLIS_FF", CLK=1, CE=4, Q=9))
    slowest = netlist.paths()[0]
    assert slowest.time == pytest.approx(0.52 + wire(2) + 0.24 + wire(1) + 0.24 + wire(1))
    assert (netlist.start(slowest), netlist.end(slowest)) == ("u_a.start_q", "u_b.end_q.CE")
    assert netlist.hops(slowest) == "TRELLIS_FF(2) > LUT4(1) > LUT4(1)"
    lines = ranking(netlist, 3.0)
    assert lines[0].startswith("2 ends; over 6.67 ns 0, over 3.0 ns 1") and len(lines) == 3
    assert "u_a.start_q -> u_b.end_q.CE" in lines[1]


def test_carries_and_wide_multiplexers_have_no_wires_inside() -> None:
    netlist = _netlist(start=_cell("TRELLIS_FF", CLK=1, Q=2), low=_cell("CCU2C", A0=2, COUT=3),
                       high=_cell("CCU2C", CIN=3, S0=4), mux=_cell("PFUMX", BLUT=4, Z=5),
                       end=_cell("TRELLIS_FF", CLK=1, DI=5, Q=9))
    assert netlist.paths()[0].time == pytest.approx(0.52 + wire(1) + 0.45 + 0.45 + 0.2 + wire(1))


@pytest.mark.parametrize(("mode", "leaves"), [("NOREG", 5.6), ("OUTREG", 1.0)])
def test_block_ram_is_slow_without_its_output_register(mode: str, leaves: float) -> None:
    netlist = _netlist(start=_cell("DP16KD", {"REGMODE_A": mode}, CLKA=1, DOA0=2), end=_cell("TRELLIS_FF", DI=2, Q=9))
    assert netlist.paths()[0].time == pytest.approx(leaves + wire(1))


def test_more_loads_are_a_longer_wire() -> None:
    assert wire(1) < wire(2) < wire(64) < 2.1


def test_once_placed_a_wire_is_as_long_as_it_reaches() -> None:
    netlist = _netlist(start=_cell("TRELLIS_FF", CLK=1, Q=2), one=_cell("LUT4", A=2, Z=3),
                       two=_cell("LUT4", A=2, Z=4), mux=_cell("PFUMX", ALUT=3, BLUT=4, C0=2, Z=5),
                       end=_cell("TRELLIS_FF", CLK=1, DI=5, Q=9))
    netlist.places = {"start": (40, 20), "one$COMB0": (12, 21), "two$COMB0": (12, 21), "end": (12, 21)}
    assert distance((40, 20), (12, 21)) == pytest.approx(0.08 * (6 + 23 + 10 + 2))
    slowest = netlist.paths()[0]
    assert slowest.time == pytest.approx(0.52 + distance((40, 20), (12, 21)) + 0.24 + 0.2)
    assert netlist.hops(slowest) == "TRELLIS_FF(3)@40,20 > LUT4(1)@12,21 > PFUMX(1)@12,21 > @12,21"
