# SPDX-License-Identifier: Apache-2.0
"""Comparison of netlists: file names and line numbers do not count, all else does."""

import json
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from sim.synth.netlist import differences, flat, main
from sim.synth.yosys import FORGET, yosys_script


def _design(line: int) -> dict[str, Any]:
    source = f"rtl/a.sv:{line}.1-{line}.9"
    return {"creator": f"Yosys {line}", "modules": {
        "big": {"attributes": {"src": source}, "cells": {f"c{k}": {} for k in range(9)}, "netnames": {}},
        "top": {"attributes": {"top": "1", "src": source}, "ports": {"clk_i": {"direction": "input", "bits": [2]}},
                "cells": {name: {"type": "TRELLIS_FF", "connections": {"CLK": [2], "Q": [3 + k]},
                                 "attributes": {"src": source, "cell_src": source, "keep": "1"}}
                          for k, name in enumerate(("a_q", "b_q"))},
                "netnames": {"q": {"bits": [3], "attributes": {"src": source}}}}}}


def test_source_lines_are_no_difference(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    paths = [tmp_path / "a.json", tmp_path / "b.json"]
    for line, path in enumerate(paths):
        path.write_text(json.dumps(_design(line)))
    assert main(list(map(str, paths))) == 0 and capsys.readouterr().out == "equal\n"


@pytest.mark.parametrize(("change", "place"), [
    (lambda top: top["cells"]["b_q"]["connections"].update(Q=[9]), "top: cells b_q"),
    (lambda top: top["cells"]["b_q"]["attributes"].pop("keep"), "top: cells b_q"),
    (lambda top: top["netnames"].update(r=top["netnames"].pop("q")), "top: netnames q"),
    (lambda top: top["cells"].update(a_q=top["cells"].pop("a_q")), "top: the order of its cells"),
    (lambda top: top["ports"]["clk_i"].update(bits=[7]), "top: attributes or ports")])
def test_each_difference_is_named(change: Any, place: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    changed = deepcopy(_design(1))
    change(changed["modules"]["top"])
    assert place in list(differences(_design(1), changed))
    paths = [tmp_path / "a.json", tmp_path / "b.json"]
    for design, path in zip((_design(1), changed), paths, strict=True):
        path.write_text(json.dumps(design))
    assert main(list(map(str, paths))) == 1 and place in capsys.readouterr().out


def test_flat_module_is_the_top() -> None:
    assert list(flat(_design(1))["cells"]) == ["a_q", "b_q"]


def test_flow_forgets_source_lines_after_reading_and_before_writing() -> None:
    lines = yosys_script("slog_fifo", "tiny", [], Path(__file__).parents[3] / "out").splitlines()
    assert lines[0].startswith("read_slang ") and tuple(lines[1:3]) == FORGET
    assert lines[-1].startswith("write_json ") and tuple(lines[-3:-1]) == FORGET
