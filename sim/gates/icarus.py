# SPDX-License-Identifier: Apache-2.0
"""The netlist of the board `tiny` in Icarus, from all-X: `tb_gates.sv` with the program of `sim.gates.program`.

`python -m sim.gates.icarus` simulates what Yosys makes, with `--routed` what nextpnr makes of that: then a second run
with one wrong bit in one look-up table must fail.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from golden.cycle.board import RESET_END
from golden.params import TINY
from sim.building import tail
from sim.gates.netlist import GATE_MODELS, ROUTED_MODELS, cells, netlist, routed
from sim.gates.plain import namer, verilog
from sim.gates.program import Program, program
from sim.gates.routed import flipped
from sim.synth.netlist import flat
from sim.toolchain import ROOT, TOP

HERE = Path(__file__).parent
MODELS = (GATE_MODELS, ROUTED_MODELS, HERE / "blocks.sv", HERE / "tb_gates.sv")
SIZE = 21, 19
RESET_CLOCKS = 1
"""Clocks for which the contract wants the board's reset pin held."""
FLAG = re.compile(r"(^|[_.])(valid|ready|busy|done|full|empty|armed|writing|refused|irq)(_[qio]\d*|_q\d*)?$")
"""Names of nets that are handshakes or flags: the last part of their path."""
WHEN = {
    r"u_video_in\.out_done_q$": ("u_video_in.out_active_q", "u_video_in.boundary_q"),
    r"u_channel\.was_valid_q$": ("u_channel.writing_q",),
    r"u_fetch\.refused_q$": ("u_fetch.wait_q",),
    r"u_best\.refused_q$": ("u_best.held_q",),
    r"u_intake\.row_refused_i$": ("u_rows.some_q",),
}
"""Flags that are data: registers without reset, which may be anything until they are loaded. Each must be known
whenever all of these nets are high: a row of outputs ends; a frame is written; a checked job waits; a row is held, or
offered."""
WRONG = "s_axil_rvalid"
"""The output before which a look-up table gets a wrong bit."""
HIGH = ("s_axil_rready",)
"""Inputs that the bench holds high."""
MISSING = "Icarus is not installed: run `apt-get install iverilog`"


def flags(module: Mapping[str, Any]) -> list[str]:
    """Names of all nets of a netlist that are handshakes or flags and not constant, in its order."""
    found = []
    for name, net in module["netnames"].items():
        live = any(isinstance(bit, int) for bit in net["bits"])
        if live and not net.get("hide_name") and FLAG.search(name.split(".")[-1]):
            found.append(name)
    return found


def _condition(module: Mapping[str, Any], name: str) -> list[str]:
    """Names of the nets that say when a flag means something; none if it always does.

    Raises:
        KeyError: if the netlist has no such net.
    """
    for pattern, conditions in WHEN.items():
        if re.search(pattern, name):
            found = [re.sub(pattern, condition, name) for condition in conditions]
            missing = [each for each in found if each not in module["netnames"]]
            if missing:
                raise KeyError(f"no net {', '.join(missing)}, which says when {name} means something")
            return found
    return []


def flags_text(module: Mapping[str, Any]) -> tuple[str, list[str]]:
    """`flags.svh`, and the name of each of its bits, the lowest first; a net of several names is taken once."""
    net, names, places = namer(module), {}, []
    for name in flags(module):
        when = [f"u_dut.{net(module['netnames'][each]['bits'][0])} === 1'b0" for each in _condition(module, name)]
        for k, bit in enumerate(module["netnames"][name]["bits"]):
            if isinstance(bit, int) and bit not in names:
                names[bit] = f"{name}[{k}]"
                places.append(f"({' || '.join(when)}) ? 1'b0 : u_dut.{net(bit)}" if when else f"u_dut.{net(bit)}")
    assigns = "\n".join(f"assign flags[{k}] = {place};" for k, place in enumerate(places))
    return f"localparam Flags = {len(places)};\nwire [Flags-1:0] flags;\n{assigns}\n", list(names.values())


def parameters(plan: Program) -> list[str]:
    """Icarus' words for the parameters of `tb_gates.sv`."""
    values = {
        "Width": plan.size[0], "Height": plan.size[1], "Steps": len(plan.steps) + 1, "Beats": len(plan.beats),
        "Reset": RESET_CLOCKS, "Settle": RESET_END}
    return [f"-Ptb_gates.{name}={value}" for name, value in values.items()]


def run(module: Mapping[str, Any], folder: Path) -> str:
    """Simulate a flat netlist, in `folder`; returns the bench's last line.

    Raises:
        SystemExit: with the end of its output if the bench fails.
    """
    plan = program(TINY, SIZE)
    folder.mkdir(parents=True, exist_ok=True)
    text, names = flags_text(module)
    for name, content in {**plan.files(), "flags.svh": text, "flags.txt": "".join(
            f"{k} {flag}\n" for k, flag in enumerate(names)), "plain.v": verilog(TOP, module)}.items():
        (folder / name).write_text(content)
    log = folder / "icarus.log"
    commands = (["iverilog", "-g2012", "-s", "tb_gates", "-I", str(folder), *parameters(plan), "-o", "gates.vvp",
                 *map(str, MODELS), "plain.v"], ["vvp", "-n", "gates.vvp"])
    with log.open("w") as out:
        for command in commands:
            done = subprocess.run(command, cwd=folder, stdout=out, stderr=subprocess.STDOUT, check=False)
            if done.returncode:
                break
    last = tail(log, 1)
    if done.returncode or not last.startswith("PASS"):
        raise SystemExit(f"the bench of the netlist fails; {log} ends:\n{tail(log, 25)}")
    return last


def run_routed() -> str:
    """Simulate what nextpnr makes of the netlist, and again with a wrong bit; returns the bench's last line.

    Raises:
        SystemExit: if the bench fails, or does not fail with the wrong bit.
    """
    folder, module = routed("tiny")
    print(f"gates: {len(module['cells'])} cells, {folder.relative_to(ROOT)}", flush=True)
    last = run(module, folder / "icarus")
    try:
        run(flipped(module, WRONG, HIGH), folder / "wrong")
    except SystemExit as failure:
        said = re.findall(r"FATAL: \S+ (.*)", str(failure))
        print(f"with a wrong bit in the table before {WRONG}: {said[0] if said else failure}")
        return last
    raise SystemExit(f"the bench does not notice a wrong bit in the look-up table before {WRONG}")


def main(argv: Sequence[str] | None = None) -> int:
    """Simulate the netlist of `tiny`.

    Raises:
        SystemExit: with one line if Icarus is not installed.
    """
    parser = argparse.ArgumentParser(prog="python -m sim.gates.icarus", description="The board's netlist, from all-X.")
    parser.add_argument("--routed", action="store_true", help="as nextpnr places and routes it")
    options = parser.parse_args(argv)
    if not shutil.which("iverilog") or not shutil.which("vvp"):
        raise SystemExit(MISSING)
    if options.routed:
        print(run_routed())
        return 0
    made = netlist(TOP, "tiny", {}, {})
    print(f"gates: {cells(made)} cells, {made.parent.relative_to(ROOT)}", flush=True)
    print(run(flat(json.loads(made.with_name("netlist.json").read_text())), made.parent / "icarus"))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
