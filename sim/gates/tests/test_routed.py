# SPDX-License-Identifier: Apache-2.0
"""Cells that nextpnr packs do what Yosys' do, for all inputs, unknown ones included; open pins get their constants."""

from __future__ import annotations

import random
import shutil
import subprocess
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from sim.gates.netlist import GATE_MODELS, ROUTED_MODELS
from sim.gates.plain import instance, verilog
from sim.gates.routed import closed, closed_module, constant, flipped, restored

has_icarus = pytest.mark.skipif(shutil.which("iverilog") is None, reason="Icarus is not installed")
OUTPUTS = "F", "FCO", "OFX", "Q", "O", "CLKO"


def _cell(kind: str, parameters: dict[str, str] | None = None, place: str = "X4/Y3/SLICEA.K0", /,
          **pins: Any) -> dict[str, Any]:
    """A cell as nextpnr writes it; a pin without a net is None."""
    return {"type": kind, "parameters": parameters or {}, "attributes": {"NEXTPNR_BEL": place},
            "connections": {pin: [] if bit is None else [bit] for pin, bit in pins.items()},
            "port_directions": {pin: "output" if pin in OUTPUTS or pin.startswith(("WADO", "WDO"))
                                else "input" for pin in pins}}


def _table(bits: int) -> str:
    return f"{bits:016b}"


@pytest.mark.parametrize(("cell", "pin", "expected"), [
    (_cell("TRELLIS_COMB", A=None), "A", "0"),
    (_cell("TRELLIS_COMB", {"MODE": "CCU2"}, A=None), "A", "1"),
    (_cell("TRELLIS_FF"), "LSR", "0"),
    (_cell("TRELLIS_FF", {"LSRMUX": "INV"}, LSR=None), "LSR", "1"),
    (_cell("DCCA", CE=None), "CE", "1"),
    (_cell("DP16KD", CEA=None), "CEA", "1"),
    (_cell("DP16KD", {"CEAMUX": "INV"}, CEA=None), "CEA", "0"),
    (_cell("DP16KD", {"OCEBMUX": "OCEB"}, OCEB=None), "OCEB", "1"),
    (_cell("DP16KD", WEA=None), "WEA", "0"),
    (_cell("DP16KD", {"WEAMUX": "WEA"}, WEA=None), "WEA", "1"),
    (_cell("DP16KD", {"RSTBMUX": "INV"}, RSTB=None), "RSTB", "0"),
    (_cell("DP16KD", {"CSA2MUX": "CSA2"}, CSA2=None), "CSA2", "1"),
    (_cell("DP16KD", ADA0=None), "ADA0", "0"),
    (_cell("DP16KD", {"ADA0MUX": "1 "}, ADA0=None), "ADA0", "1"),
    (_cell("DP16KD", {"DIB17MUX": "0 "}, DIB17=None), "DIB17", "0"),
    (_cell("MULT18X18D", {"A3MUX": "1 "}, A3=None), "A3", "1"),
    (_cell("MULT18X18D", B0=None), "B0", "0"),
])
def test_open_pins(cell: dict[str, Any], pin: str, expected: str) -> None:
    """An open pin counts as what the bitstream makes of it."""
    assert constant(cell, pin) == expected


@pytest.mark.parametrize(("cell", "message"), [
    (_cell("TRELLIS_FF", {"CEMUX": "CE", "SD": "1 "}, CLK=2, DI=3, CE=None, Q=4), "reads its pin CE, which is open"),
    (_cell("TRELLIS_FF", {"SD": "0 "}, CLK=2, M=None, Q=4), "reads its pin M, which is open"),
    (_cell("MULT18X18D", {"REG_OUTPUT_CLK": "CLK0"}, **dict.fromkeys(("SIGNEDA", "SIGNEDB", "SOURCEA", "SOURCEB"), 2)),
     "reads its pin CLK0, which is open"),
    (_cell("TRELLIS_COMB", {"MODE": "DPRAM", "INITVAL": _table(0)}, A=None, F=3), "reads its pin A, which is open"),
    (_cell("TRELLIS_COMB", {"MODE": "CCU2", "INITVAL": _table(0x8000)}, FCI=None, FCO=3), "its pin FCI, which is open"),
    (_cell("TRELLIS_COMB", {"MODE": "CCU2", "INITVAL": _table(0)}, FCI=None, F=3), "its pin FCI, which is open"),
    (_cell("TRELLIS_COMB", {"INITVAL": _table(0), "NEW": "1"}, F=3), "has the parameter NEW, which is not modelled"),
    (_cell("TRELLIS_COMB", {"INITVAL": _table(0)}, "X4/Y3/MULT18_0", OFX=3, M=2, F1=4), "has no place"),
    (_cell("TRELLIS_IO", {"DIR": "BIDIR"}, B=2, I=3, O=4), "neither a plain input nor"),
    (_cell("TRELLIS_IO", {"DIR": "OUTPUT"}, B=2, I=3, T=4), "neither a plain input nor"),
    (_cell("EHXPLLL", CLKI=2), "cell EHXPLLL is not modelled"),
])
def test_what_nothing_determines_is_refused(cell: dict[str, Any], message: str) -> None:
    """An open pin that the outputs depend on, and a cell, mode or parameter without a model."""
    with pytest.raises(ValueError, match=message):
        closed(cell)


def test_a_pin_that_is_not_read_goes() -> None:
    """Only what the mode reads stays, with the constants of open pins."""
    cell = closed(_cell("TRELLIS_COMB", {"INITVAL": _table(5)}, A=2, B=None, C=3, D=None, WD=None, WRE=9, FCI=None, F=4,
                        FCO=None, OFX=None, DI0=None))
    assert cell["connections"] == {"A": [2], "B": ["0"], "C": [3], "D": ["0"], "F": [4]}
    assert cell["parameters"] == {"INITVAL": _table(5), "MUX": "F1"}


IN = {"a": 2, "b": 3, "c": 4, "d": 5, "e": 6, "clk": 7}
"""Inputs of the small netlists, by their nets' numbers."""


def _pair(number: int, first: dict[str, Any], second: dict[str, Any], joined: int) -> dict[str, Any]:
    """A carry cell of Yosys' as the two halves that nextpnr makes of it."""
    return {f"half{number}_0": {**first, "connections": {**first["connections"], "FCO": [joined]}},
            f"half{number}_1": {**second, "connections": {**second["connections"], "FCI": [joined]}}}


def _ports(cells: dict[str, Any], outs: dict[str, int]) -> dict[str, Any]:
    return {"ports": {**{name: {"direction": "input", "bits": [bit]} for name, bit in IN.items()},
                      **{name: {"direction": "output", "bits": [bit]} for name, bit in outs.items()}},
            "cells": cells, "netnames": {}}


def _alike(tmp_path: Path, yosys: dict[str, Any], routed: dict[str, Any], outs: dict[str, int], steps: str) -> str:
    """Icarus' verdict on three netlists with the same ports: cells of Yosys', cells of nextpnr's, and these as plain
    Verilog."""
    module = closed_module(_ports(routed, outs))

    def models(name: str, cells: dict[str, Any], ports: dict[str, int]) -> str:
        nets = {ports[name]: name for name in IN}
        top = max(bit for cell in cells.values() for bits in cell["connections"].values() for bit in bits
                  if isinstance(bit, int))
        lines = [instance(k, cell, lambda bit: nets.get(bit, f"n[{bit}]") if isinstance(bit, int) else f"1'b{bit}")
                 for k, cell in enumerate(cells.values())]
        return (f"module {name} (input {', '.join(IN)}, output {', '.join(outs)}); wire n[0:{top}];\n"
                + "\n".join([*lines, *(f"assign {name} = n[{ports[name]}];" for name in outs)]) + "\nendmodule\n")

    kinds = ("yosys", "routed", "plain")
    width = len(outs)
    bench = "\n".join(f"wire [{width - 1}:0] w_{kind}; {kind} u_{kind} ({', '.join(IN)}, "
                      f"{', '.join(f'w_{kind}[{k}]' for k in range(width))});" for kind in kinds)
    (tmp_path / "t.sv").write_text(
        models("yosys", yosys, {**IN, **outs})
        + models("routed", module["cells"], {name: port["bits"][0] for name, port in module["ports"].items()})
        + verilog("plain", module) + f"""
module tb;
  reg a, b, c, d, e, clk = 0;
  {bench}
  integer checks = 0;
  task check; begin
    checks = checks + 1;
    if (w_yosys !== w_routed || w_yosys !== w_plain) begin
      $display("%b: %b, routed %b, plain %b", {{{', '.join(IN)}}}, w_yosys, w_routed, w_plain);
      $finish;
    end
  end endtask
  initial begin {steps} $display("PASS"); $finish; end
endmodule
""")
    made = tmp_path / "t.vvp"
    subprocess.run(["iverilog", "-g2012", "-s", "tb", "-o", made, GATE_MODELS, ROUTED_MODELS, tmp_path / "t.sv"],
                   check=True)
    return subprocess.run(["vvp", "-n", made], check=True, capture_output=True, text=True).stdout.splitlines()[-1]


ALL = "\n".join(f"{{a, b, c, d, e}} = 5'b{''.join(each)}; #1 check;" for each in product("01x", repeat=5))
"""Every combination of 0, 1 and X at five inputs."""


def _tables() -> list[int]:
    """Tables of one bit, of all bits but one, and some others: sums, and those of nextpnr's own carry cells."""
    rng = random.Random(1)
    return [*(1 << k for k in range(16)), *(0xFFFF ^ 1 << k for k in range(16)), 0x96AA, 0x5A3A, 0x000A, 0xFFFF, 0,
            *(rng.randrange(1 << 16) for _ in range(8))]


def _logic(tables: list[int], routed: list[int]) -> tuple[dict[str, Any], dict[str, Any], dict[str, int]]:
    """Look-up tables, carry cells of every kind, and wide multiplexers; the tables of Yosys' cells and of nextpnr's."""
    yosys, outs, free = {}, {}, iter(range(100, 100_000))
    made = {"clock": _cell("TRELLIS_FF", {"SD": "0 "}, CLK=7, M=2, Q=next(free))}

    def out(name: str) -> int:
        outs[name] = next(free)
        return outs[name]

    for k, (ours, theirs) in enumerate(zip(tables, routed, strict=True)):
        z = out(f"z{k}")
        yosys[f"lut{k}"] = {"type": "LUT4", "parameters": {"INIT": _table(ours)},
                            "connections": {"A": [2], "B": [3], "C": [4], "D": [5], "Z": [z]}}
        made[f"lut{k}"] = _cell("TRELLIS_COMB", {"INITVAL": _table(theirs)}, A=2, B=3, C=4, D=5, F=z)
        apart = [("NO", "YES")[k >> n & 1] for n in range(2)]
        s0, s1, co = out(f"s{k}"), out(f"t{k}"), out(f"co{k}")
        yosys[f"carry{k}"] = {
            "type": "CCU2C", "parameters": {"INIT0": _table(ours), "INIT1": _table(tables[-1 - k]),
                                            "INJECT1_0": apart[0], "INJECT1_1": apart[1]},
            "connections": {pin: [bit] for pin, bit in {
                "A0": 2, "B0": 3, "C0": 4, "D0": "1", "A1": 4, "B1": "1", "C1": 5, "D1": 2, "CIN": 6, "S0": s0,
                "S1": s1, "COUT": co}.items()}}
        made |= _pair(
            k, _cell("TRELLIS_COMB", {"MODE": "CCU2", "INITVAL": _table(theirs), "CCU2_INJECT1": apart[0]}, A=2, B=3,
                     C=4, D=None, FCI=6, F=s0, FCO=0),
            _cell("TRELLIS_COMB", {"MODE": "CCU2", "INITVAL": _table(routed[-1 - k]), "CCU2_INJECT1": apart[1]},
                  "X4/Y3/SLICEA.K1", A=4, B=None, C=5, D=2, FCI=0, F=s1, FCO=co), next(free))
    first = [outs[f"z{k}"] for k in range(4)]
    five, six = [out("five0"), out("five1")], out("six")
    for k in range(2):
        yosys[f"five{k}"] = {"type": "PFUMX", "parameters": {}, "connections": {
            "BLUT": [first[2 * k]], "ALUT": [first[2 * k + 1]], "C0": [6], "Z": [five[k]]}}
        made[f"lut{2 * k}"]["connections"] |= {"F1": [first[2 * k + 1]], "M": [6], "OFX": [five[k]]}
        made[f"lut{2 * k}"]["port_directions"] |= {"F1": "input", "M": "input", "OFX": "output"}
    yosys["six"] = {"type": "L6MUX21", "parameters": {}, "connections": {"D0": [five[0]], "D1": [five[1]], "SD": [2],
                                                                         "Z": [six]}}
    made["lut1"]["connections"] |= {"FXA": [five[0]], "FXB": [five[1]], "M": [2], "OFX": [six]}
    made["lut1"]["port_directions"] |= {"FXA": "input", "FXB": "input", "M": "input", "OFX": "output"}
    made["lut1"]["attributes"]["NEXTPNR_BEL"] = "X4/Y3/SLICEA.K1"
    return yosys, made, outs


@has_icarus
def test_logic(tmp_path: Path) -> None:
    """Tables, both halves of carry cells with either injection, five- and six-input multiplexers."""
    tables = _tables()
    yosys, routed, outs = _logic(tables, tables)
    assert _alike(tmp_path, yosys, routed, outs, ALL) == "PASS"


@has_icarus
@pytest.mark.parametrize("bit", [0, 6, 15])
def test_a_flipped_bit_is_noticed(bit: int, tmp_path: Path) -> None:
    """One bit of one look-up table wrong in the netlist that nextpnr wrote."""
    tables = _tables()
    yosys, routed, outs = _logic(tables, [tables[0] ^ 1 << bit, *tables[1:]])
    assert _alike(tmp_path, yosys, routed, outs, ALL) != "PASS"


@has_icarus
def test_registers(tmp_path: Path) -> None:
    """Registers with every kind of enable, reset, order of the two and start value, read through either data pin."""
    yosys, routed, outs = {}, {}, {}
    for k, (enable, reset, order, start, through) in enumerate(product(
            ("CE", "INV", "0 ", "1 "), ("LSR", "INV", None), ("LSR_OVER_CE", "CE_OVER_LSR"), ("SET", "RESET"), "01")):
        parameters = {"CEMUX": enable, "LSRMUX": reset or "LSR", "SRMODE": order, "REGSET": start, "GSR": "DISABLED"}
        q = outs[f"q{k}"] = 100 + k
        yosys[f"ff{k}"] = {"type": "TRELLIS_FF", "parameters": parameters,
                           "connections": {"CLK": [7], "CE": [2], "LSR": [3] if reset else ["0"], "DI": [4], "Q": [q]}}
        routed[f"ff{k}"] = _cell("TRELLIS_FF", {**parameters, "SD": through + " "}, CLK=7, LSR=3 if reset else None,
                                 CE=2 if enable in ("CE", "INV") else None, Q=q,
                                 **({"DI": 4, "M": None} if through == "1" else {"M": 4}))
    steps = "\n".join(f"{{a, b, c}} = 3'b{''.join(each)}; #1 check; clk = 1; #1 check; clk = 0; #1;"
                      for each in [*product("01", repeat=3), *product("01x", repeat=3)])
    assert _alike(tmp_path, yosys, routed, outs, steps) == "PASS"


@has_icarus
def test_memory(tmp_path: Path) -> None:
    """A memory in look-up tables: four tables, and the half slice that takes address and data to them."""
    bits = {"di": [2, 3, 4, 5], "wad": [4, 2, 5, 3], "rad": [3, 5, 2, 4], "do": [20, 21, 22, 23]}
    yosys = {"ram": {"type": "TRELLIS_DPR16X4", "parameters": {"WCKMUX": "WCK", "WREMUX": "WRE"}, "connections": {
        "DI": bits["di"], "WAD": bits["wad"], "RAD": bits["rad"], "WRE": [6], "WCK": [7], "DO": bits["do"]}}}
    w, r, d = bits["wad"], bits["rad"], bits["di"]
    routed = {"ramw": _cell("TRELLIS_RAMW", D0=w[0], B0=w[1], C0=w[2], A0=w[3], C1=d[0], A1=d[1], D1=d[2], B1=d[3],
                            **{f"WADO{k}": 40 + k for k in range(4)}, **{f"WDO{k}": 50 + k for k in range(4)})}
    for k in range(4):
        routed[f"ram{k}"] = _cell(
            "TRELLIS_COMB", {"MODE": "DPRAM", "INITVAL": _table(0), "WCKMUX": "WCK", "WREMUX": "WRE"}, D=r[0], B=r[1],
            C=r[2], A=r[3], WRE=6, WCK=7, WD=50 + k, F=bits["do"][k], FCI=None, **{f"WAD{n}": 40 + n for n in range(4)})
    rng = random.Random(2)
    each = [*product("01", repeat=5), *(rng.choices("01", k=5) for _ in range(300)), *product("01x", repeat=5)]
    steps = "\n".join(f"{{a, b, c, d, e}} = 5'b{''.join(bits)}; #1 check; clk = 1; #1 check; clk = 0; #1;"
                      for bits in each)
    routed["clock"] = _cell("TRELLIS_FF", {"SD": "0 "}, CLK=7, M=2, Q=60)
    assert _alike(tmp_path, yosys, routed, {f"do{k}": bit for k, bit in enumerate(bits["do"])}, steps) == "PASS"


def test_restored() -> None:
    """Ports and names are those of the netlist that nextpnr took, bits of vectors too; a net that is gone has none."""
    module = {"cells": {"pad": {"connections": {"B": [21], "I": [22]}}}, "ports": {}, "netnames": {
        "full_q[2]": {"bits": [20]}, "out": {"bits": [21]}}}
    before: dict[str, Any] = {
        "netnames": {"full_q": {"offset": 2, "bits": [7, 8]}, "u_b.out": {"bits": [9]}, "out": {"bits": [9]},
                     "low": {"bits": ["0"]}},
        "ports": {"out": {"direction": "output", "bits": [9]}}}
    found = restored(module, before)
    assert {name: net["bits"] for name, net in found["netnames"].items()} == {
        "full_q": [20, "x"], "u_b.out": [21], "out": [21], "low": ["0"]}
    assert found["ports"] == {"out": {"direction": "output", "bits": [21]}}
    before["ports"]["low"] = {"direction": "output", "bits": ["0"]}
    with pytest.raises(ValueError, match="a bit of the port low is no pin"):
        restored(module, before)


def test_flipped() -> None:
    """One bit of the table before an output's register, and nothing else, changes: that at rest."""
    cells = {"lut": _cell("TRELLIS_COMB", {"INITVAL": _table(5)}, A=8, B=23, F=20),
             "pads": _cell("TRELLIS_IO", {"DIR": "INPUT"}, B=2, O=8),
             "ff": _cell("TRELLIS_FF", {"SD": "1 "}, CLK=7, DI=20, LSR=None, Q=21),
             "pad": _cell("TRELLIS_IO", {"DIR": "OUTPUT"}, I=21, B=22)}
    cells["pad"]["port_directions"]["B"] = "inout"
    module = closed_module(_ports(cells, {"o": 22}))
    wrong = flipped(module, "o", ["a"])
    assert {name for name in cells if wrong["cells"][name] != module["cells"][name]} == {"lut"}
    assert wrong["cells"]["lut"]["parameters"]["INITVAL"] == _table(5 ^ 2)
    with pytest.raises(ValueError, match="no look-up table drives the register of e"):
        flipped(module, "e", [])
