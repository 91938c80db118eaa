# SPDX-License-Identifier: Apache-2.0
"""Routes that do not connect what the netlist connects are found."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import pytest

from sim.gates.routes import check, wire


def _cell(kind: str, place: str, mode: str = "", /, **pins: int) -> dict[str, Any]:
    return {"type": kind, "attributes": {"NEXTPNR_BEL": place}, "parameters": {"MODE": mode} if mode else {},
            "connections": {pin: [bit] for pin, bit in pins.items()},
            "port_directions": {pin: "output" if pin in ("Q", "F", "O", "CLKO", "WADO0") else "input" for pin in pins}}


def _net(bit: int, *hops: str) -> dict[str, Any]:
    """A net whose wires are each `place;switch`."""
    return {"bits": [bit], "attributes": {"ROUTING": ";".join(f"{hop};1" for hop in hops)}}


Q = ("X4/Y3/Q0_SLICE;", "X4/Y3/Q0;X4/Y3/0_0_Q0_SLICE->0_0_Q0", "X5/Y3/H01E0001;X4/Y3/0_0_Q0->1_0_H01E0001",
     "X5/Y3/B3;X5/Y3/0_0_H01E0001->0_0_B3", "X5/Y3/A3_SLICE;X5/Y3/0_0_B3->0_0_A3_SLICE")
PAD = "X0/Y9/JPADDIA_PIO;", "X0/Y0/G_CLKI_TDCC0;X9/Y0/-9_9_JPADDIA_PIO->-9_0_G_CLKI_TDCC0"
CLK = ("X0/Y0/G_CLKO_TDCC0;", "X4/Y3/G_HPBX0000;", "X4/Y3/CLK0;X4/Y3/0_0_G_HPBX0000->0_0_CLK0",
       "X4/Y3/CLK0_SLICE;X4/Y3/0_0_CLK0->0_0_CLK0_SLICE")
GOOD = {"cells": {"ff": _cell("TRELLIS_FF", "X4/Y3/SLICEA.FF0", Q=2, CLK=3),
                  "lut": _cell("TRELLIS_COMB", "X5/Y3/SLICEB.K1", A=2, F=4),
                  "pad": _cell("TRELLIS_IO", "X0/Y9/PIOA", O=5),
                  "clock": _cell("DCCA", "X9/Y9/TDCC0", CLKI=5, CLKO=3)},
        "netnames": {"q": _net(2, *Q), "clk": _net(3, *CLK), "pad": _net(5, *PAD),
                     "unused": {"bits": [4], "attributes": {"ROUTING": " "}}}}


def _changed(net: str, *hops: str) -> dict[str, Any]:
    module = deepcopy(GOOD)
    module["netnames"][net] = _net(module["netnames"][net]["bits"][0], *hops)
    return module


def test_good_routes() -> None:
    """All nets and wires count; an output that nothing reads has none, a global network begins anywhere."""
    assert check(GOOD) == (3, 11)


@pytest.mark.parametrize(("module", "message"), [
    (_changed("q", *Q[:-1]), "lut.A is the wire X5/Y3/A3_SLICE, which belongs to no net"),
    (_changed("q", *Q[:2], *Q[3:]), "net q: nothing drives X5/Y3/H01E0001"),
    (_changed("q", *Q[1:]), "net q begins at no wire, not at X4/Y3/Q0_SLICE"),
    (_changed("q", "X4/Y3/Q1_SLICE;", *Q), "net q begins at X4/Y3/Q0_SLICE, X4/Y3/Q1_SLICE"),
    (_changed("q", *Q[:-1], "X5/Y3/A3_SLICE;X5/Y3/0_0_B3->0_0_C3_SLICE"), "switch of X5/Y3/A3_SLICE drives X5/Y3/C3"),
    (_changed("q", *Q[:-1], "X5/Y3/A3_SLICE;X5/Y3/B3"), "no such switch"),
    (_changed("q", *Q[:2], "X5/Y3/H01E0001;X5/Y3/0_0_B3->0_0_H01E0001", *Q[3:]), "net q: nothing drives"),
    (_changed("q", *Q, "X5/Y3/B3_SLICE;X5/Y3/0_0_B3->0_0_B3_SLICE"), "lut.B is the wire X5/Y3/B3_SLICE, .* to q"),
    (_changed("clk", *CLK, "X5/Y3/B3;X4/Y3/0_0_G_HPBX0000->1_0_B3"), "X5/Y3/B3 belongs to the nets q and clk"),
    (_changed("clk", *CLK, "X5/Y3/G_HPBX0500;"), "net clk is on the global networks 0000, 0500, not on one"),
    (_changed("clk", *CLK[:2], "X4/Y3/CLK0;X4/Y3/0_0_G_HPBX0100->0_0_CLK0", CLK[3]), "global networks 0000, 0100"),
    (_changed("clk", "X0/Y0/G_CLKO_TDCC7;", *CLK[1:]), "begins at X0/Y0/G_CLKO_TDCC7, not at X0/Y0/G_CLKO_TDCC0"),
    (_changed("q", *Q, Q[-1]), "net q: X5/Y3/A3_SLICE has two switches"),
    (_changed("clk", CLK[0]), "net clk is on the global networks none, not on one"),
    (_changed("pad"), "clock.CLKI is the wire X0/Y0/G_CLKI_TDCC0, which belongs to no net"),
    (_changed("q", *Q, "X4/Y3/CE0_SLICE;X4/Y3/0_0_Q0->0_0_CE0_SLICE"), "ff.CE is the wire .* to q"),
    (_changed("q", *Q, "X4/Y3/LSR0_SLICE;X4/Y3/0_0_Q0->0_0_LSR0_SLICE"), "ff.LSR is the wire .* to q"),
    (_changed("clk", *CLK[:-1]), "ff.CLK is the wire X4/Y3/CLK0_SLICE, which belongs to no net"),
])
def test_wrong_routes(module: dict[str, Any], message: str) -> None:
    """A pin that is not reached, a break, a second source, a false switch, a ring, a pin or wire of another net, two
    global networks or none."""
    with pytest.raises(ValueError, match=message):
        check(module)


def test_two_nets_on_one_global_network() -> None:
    """Each buffer has a network of its own."""
    module = deepcopy(GOOD)
    module["cells"]["other"] = _cell("DCCA", "X9/Y9/TDCC1", CLKO=7)
    module["netnames"]["rst"] = _net(7, "X0/Y0/G_CLKO_TDCC1;", "X8/Y3/G_HPBX0000;")
    with pytest.raises(ValueError, match="global network 0000 belongs to clk and rst"):
        check(module)


def test_open_pins_that_are_a_neighbours_wires() -> None:
    """A table's open F1 is the output of the table beside it, whose net is not its business; its own open B is."""
    module = deepcopy(GOOD)
    module["cells"]["lut"]["connections"] |= {"F1": [], "B": []}
    module["cells"]["beside"] = _cell("TRELLIS_COMB", "X5/Y3/SLICEC.K0", F=6)
    module["netnames"]["f"] = _net(6, "X5/Y3/F4_SLICE;")
    assert check(module) == (4, 12)
    module["netnames"]["f"] = _net(6, "X5/Y3/F4_SLICE;", "X5/Y3/B3_SLICE;X5/Y3/0_0_F4_SLICE->0_0_B3_SLICE")
    with pytest.raises(ValueError, match=r"lut\.B is the wire X5/Y3/B3_SLICE, which belongs to f"):
        check(module)


@pytest.mark.parametrize(("mode", "pin", "through", "good"), [
    ("LOGIC", "A", "D", True), ("CCU2", "A", "B", True), ("CCU2", "A", "C", False), ("CCU2", "D", "C", True),
    ("DPRAM", "A", "B", False), ("DPRAM", "A", "A", True)])
def test_inputs_that_change_places(mode: str, pin: str, through: str, good: bool) -> None:
    """Inputs change places where the table can follow; those of memories and of carry cells have fixed tasks."""
    module = _changed("q", *Q[:-2], f"X5/Y3/{through}3;X5/Y3/0_0_H01E0001->0_0_{through}3",
                      f"X5/Y3/{pin}3_SLICE;X5/Y3/0_0_{through}3->0_0_{pin}3_SLICE")
    module["cells"]["lut"] = _cell("TRELLIS_COMB", "X5/Y3/SLICEB.K1", mode, **{pin: 2})
    if good:
        assert check(module) == (3, 11)
    else:
        with pytest.raises(ValueError, match=f"lut.{pin} is reached through the slice's pin {through}"):
            check(module)


@pytest.mark.parametrize(("place", "kind", "pin", "name"), [
    ("SLICED.K1", "TRELLIS_COMB", "FCO", "FCO"), ("SLICEA.K0", "TRELLIS_COMB", "FCI", "FCI"),
    ("SLICEB.K0", "TRELLIS_COMB", "FCI", "FCIB"), ("SLICEB.K0", "TRELLIS_COMB", "FCO", "FCIB1"),
    ("SLICEB.K1", "TRELLIS_COMB", "FCI", "FCIB1"), ("SLICEB.K1", "TRELLIS_COMB", "FCO", "FCOB"),
    ("SLICEC.K0", "TRELLIS_COMB", "OFX", "F5C"), ("SLICEC.K1", "TRELLIS_COMB", "OFX", "FXC"),
    ("SLICEC.K0", "TRELLIS_COMB", "F1", "F5"), ("SLICEC.K1", "TRELLIS_COMB", "FXB", "FXBC"),
    ("SLICEB.K1", "TRELLIS_COMB", "WD", "WD1B"), ("SLICEB.K1", "TRELLIS_COMB", "WAD3", "WAD3B"),
    ("SLICEB.K1", "TRELLIS_COMB", "WRE", "WRE1"), ("SLICEC.RAMW", "TRELLIS_RAMW", "D1", "D5"),
    ("SLICEC.RAMW", "TRELLIS_RAMW", "WADO2", "WADO2C"), ("SLICED.FF1", "TRELLIS_FF", "M", "M7"),
    ("SLICED.FF1", "TRELLIS_FF", "LSR", "LSR3")])
def test_wires_of_pins(place: str, kind: str, pin: str, name: str) -> None:
    """The wires that pins of a slice are."""
    assert wire(_cell(kind, f"X4/Y3/{place}"), pin) == f"X4/Y3/{name}_SLICE"


def test_wires_of_blocks() -> None:
    """The wires that pins of blocks and pads are; a place that is unknown is refused."""
    assert wire(_cell("DP16KD", "X13/Y46/EBR0"), "ADA3") == "X13/Y46/JADA3_EBR"
    assert wire(_cell("MULT18X18D", "X83/Y34/MULT18_5"), "P7") == "X83/Y34/JP7_MULT18"
    assert wire(_cell("TRELLIS_IO", "X0/Y20/PIOA"), "I") == "X0/Y20/PADDOA_PIO"
    assert wire(_cell("TRELLIS_IO", "X0/Y20/PIOC"), "T") == "X0/Y20/PADDTC_PIO"
    assert wire(_cell("TRELLIS_IO", "X0/Y20/PIOA"), "B") is None
    assert wire(_cell("DCCA", "X67/Y0/TDCC1"), "CE") == "X0/Y0/G_JCE_TDCC1"
    with pytest.raises(ValueError, match="no place that is known: 'X1/Y1/SITE'"):
        wire(_cell("TRELLIS_FF", "X1/Y1/SITE"), "Q")
