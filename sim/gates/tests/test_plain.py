# SPDX-License-Identifier: Apache-2.0
"""Expressions of cells are those of their models, also for unknown values; the bench's program is what it should be."""

from __future__ import annotations

import shutil
import subprocess
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from golden.params import TINY
from sim.gates import icarus
from sim.gates.icarus import flags, flags_text, main
from sim.gates.netlist import GATE_MODELS
from sim.gates.plain import instance, lut, register, verilog
from sim.gates.program import CHECK, END, FRAME, JOBS, POLL, program

has_icarus = pytest.mark.skipif(shutil.which("iverilog") is None, reason="Icarus is not installed")


def _cell(kind: str, parameters: dict[str, str], **pins: Any) -> dict[str, Any]:
    return {"type": kind, "parameters": parameters, "connections": {pin: [bit] for pin, bit in pins.items()}}


def _module(cells: dict[str, Any], inputs: dict[str, int], outputs: dict[str, int]) -> dict[str, Any]:
    ports = {name: {"direction": way, "bits": [bit]} for way, group in (("input", inputs), ("output", outputs))
             for name, bit in group.items()}
    return {"ports": ports, "cells": cells, "netnames": {}}


CELLS = {
    "lut": _cell("LUT4", {"INIT": f"{0x8A3C:016b}"}, A=2, B=3, C=4, D=5, Z=20),
    "wide": _cell("PFUMX", {}, ALUT=20, BLUT=2, C0=3, Z=21),
    "wider": _cell("L6MUX21", {}, D0=21, D1=4, SD=5, Z=22),
    "carry": _cell("CCU2C", {"INIT0": f"{0x96AA:016b}", "INIT1": f"{0x5A3A:016b}", "INJECT1_0": "NO",
                             "INJECT1_1": "YES"}, CIN=2, A0=3, B0=4, C0="0", D0="1", A1=4, B1=5, C1=3, D1="1", S0=23,
                   S1=24, COUT=25),
    "over": _cell("TRELLIS_FF", {"CEMUX": "INV", "REGSET": "SET", "SRMODE": "LSR_OVER_CE"}, CLK=6, LSR=2, CE=3, DI=4,
                  Q=26),
    "under": _cell("TRELLIS_FF", {"CEMUX": "CE", "LSRMUX": "INV", "SRMODE": "CE_OVER_LSR"}, CLK=6, LSR=3, CE=4, DI=5,
                   Q=27),
    "free": _cell("TRELLIS_FF", {"CEMUX": "1 ", "LSRMUX": "0 "}, CLK=6, DI=20, Q=28),
}
INPUTS = {"a": 2, "b": 3, "c": 4, "d": 5, "clk": 6}
OUTPUTS = {f"o{k}": k for k in range(20, 29)}


def test_lut() -> None:
    """Constants and inputs without effect leave the expression."""
    assert lut(0xFF00, ("a", "b", "c", "d")) == "d"
    assert lut(0x5555, ("a", "b", "c", "d")) == "~a"
    assert lut(0, ("a", "b", "c", "d")) == "1'b0"
    assert lut(0x6, ("a", "b")) == "(b ? ~a : a)"


def test_modes_that_are_not_modelled() -> None:
    """An asynchronous register, and a kind of cell without a model, are refused."""
    with pytest.raises(ValueError, match="mode that is not modelled"):
        register(0, _cell("TRELLIS_FF", {"SRMODE": "ASYNC"}, CLK=6, DI=2, Q=3), str)
    with pytest.raises(ValueError, match="cell EHXPLLL is not modelled"):
        verilog("t", _module({**CELLS, "pll": _cell("EHXPLLL", {}, CLKI=2)}, INPUTS, OUTPUTS))


@has_icarus
def test_same_as_models(tmp_path: Path) -> None:
    """Every combination of 0, 1 and X at the inputs gives what the models give, registers' states included."""
    module = _module(CELLS, INPUTS, OUTPUTS)
    nets = {bit: called for called, bit in INPUTS.items()} | {bit: f"m{bit}" for bit in OUTPUTS.values()}
    instances = [instance(k, cell, lambda bit: nets.get(bit, f"1'b{bit}")) for k, cell in enumerate(CELLS.values())]
    outs = [f"m{bit}" for bit in OUTPUTS.values()]
    steps = "\n".join(f"{{a, b, c, d}} = 4'b{''.join(each)}; #1 check; clk = 1; #1 check; clk = 0; #1;"
                      for each in product("01x", repeat=4))
    (tmp_path / "t.sv").write_text(verilog("plain", module) + f"""
module tb;
  reg a, b, c, d, clk = 0;
  wire {', '.join(outs)};
  wire {', '.join(OUTPUTS)};
  plain u_plain ({', '.join(f'.{port}({port})' for port in [*INPUTS, *OUTPUTS])});
  {' '.join(instances)}
  task check; if ({{{', '.join(OUTPUTS)}}} !== {{{', '.join(outs)}}}) begin
    $display("%b: %b is not %b", {{{', '.join(INPUTS)}}}, {{{', '.join(OUTPUTS)}}}, {{{', '.join(outs)}}});
    $finish;
  end endtask
  initial begin {steps} $display("PASS"); $finish; end
endmodule
""")
    made = tmp_path / "t.vvp"
    subprocess.run(["iverilog", "-g2012", "-s", "tb", "-o", made, GATE_MODELS, tmp_path / "t.sv"], check=True)
    assert subprocess.run(["vvp", "-n", made], check=True, capture_output=True, text=True).stdout.endswith("PASS\n")


def test_flags() -> None:
    """Handshakes and flags are found by name, each net once; one that is data counts only when it means something."""
    nets = {"u_a.wr_valid_q": [7], "u_b.wr_valid": [7], "u_b.level_q": [8], "u_b.done_q": [9, "0"],
            "u_channel.was_valid_q": [10], "u_channel.writing_q": [11]}
    module = {**_module({}, {}, {}), "netnames": {name: {"bits": bits} for name, bits in nets.items()}}
    assert "u_b.level_q" not in flags(module)
    text, names = flags_text(module)
    assert names == ["u_a.wr_valid_q[0]", "u_b.done_q[0]", "u_channel.was_valid_q[0]", "u_channel.writing_q[0]"]
    assert "assign flags[2] = (u_dut.n[11] === 1'b0) ? 1'b0 : u_dut.n[10];" in text
    del module["netnames"]["u_channel.writing_q"]
    with pytest.raises(KeyError, match=r"no net u_channel\.writing_q"):
        flags_text(module)


def test_program() -> None:
    """A frame from each camera, ten jobs with their results; refused jobs and streamed scores are among them."""
    plan = program(TINY, icarus.SIZE)
    operations = [step[0] for step in plan.steps]
    assert operations.count(FRAME) == TINY.cameras and operations.count(POLL) >= 2 * JOBS
    assert operations.count(CHECK) > 7 * JOBS and plan.beats
    text = plan.files()
    assert int(text["program.hex"].splitlines()[-1], 16) == END
    assert len(text["frame0.hex"].split()) == icarus.SIZE[0] * icarus.SIZE[1]


def test_icarus_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without Icarus one line says what to install, before anything is synthesised."""
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(SystemExit, match="apt-get install iverilog"):
        main([])
