# SPDX-License-Identifier: Apache-2.0
"""What is given to nextpnr."""

import json
from pathlib import Path
from typing import Any

import pytest

from sim.synth import nextpnr

PLACED = {"modules": {"top": {"settings": {"seed": "1"}, "cells": {
    "a": {"type": "TRELLIS_COMB", "connections": {"A": [], "F": [2]}, "attributes": {"NEXTPNR_BEL": "X1/Y2/SLICEA.K0"}},
    "b": {"type": "DP16KD", "connections": {"ADA0": [], "DOA0": [3]}, "attributes": {"NEXTPNR_BEL": "X1/Y2/EBR0"}}}}}}


def test_cells_are_placed_again_before_they_are_routed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where they were: nextpnr must place a cell to know which of its inputs may change places. Blocks keep pins."""
    calls: list[tuple[list[Any], dict[str, Any]]] = []

    def run(name: str, log: Path, *args: Any, **options: Any) -> bool:
        words = list(args)
        made = {flag: words[words.index(flag) + 1] for flag in ("--json", "--write", "--report") if flag in words}
        calls.append((words, json.loads(made["--json"].read_text())["modules"]["top"]))
        for flag, content in (("--write", PLACED), ("--report", {"fmax": 1})):
            if flag in made:
                made[flag].write_text(json.dumps(content))
        return True

    monkeypatch.setattr(nextpnr, "run_tool", run)
    (tmp_path / "netlist.json").write_text(json.dumps(PLACED))
    written = tmp_path / "routed.json"
    assert nextpnr.route(tmp_path, 7, True, (123, 100), written) == {"fmax": 1}
    (place, _), (route, module) = calls
    assert place[place.index("--seed") + 1] == "7" and "--no-route" in place
    assert [words[words.index("--freq") + 1] for words in (place, route)] == ["123", "123"]
    assert "--no-pack" in route and "--no-place" not in route and route[route.index("--write") + 1] == written
    assert [cell["attributes"] for cell in module["cells"].values()] == [
        {"BEL": "X1/Y2/SLICEA.K0"}, {"BEL": "X1/Y2/EBR0"}]
    assert [cell["connections"] for cell in module["cells"].values()] == [
        {"A": [], "F": [2]}, {"ADA0": ["x"], "DOA0": [3]}]
    assert module["settings"].items() >= {"seed": "1", "target_freq": "123000000.000000",
                                          **nextpnr.ROUTER_SETTINGS}.items()


def test_each_try_has_its_own_target(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A placed design holds the target that it was placed for, which nextpnr takes before that of its options."""
    aims: list[str] = []

    def run(name: str, log: Path, *args: Any, **options: Any) -> bool:
        words = list(args)
        settings = json.loads(words[words.index("--json") + 1].read_text())["modules"]["top"]["settings"]
        for flag, content in (("--write", PLACED), ("--report", {"fmax": 1})):
            if flag in words:
                words[words.index(flag) + 1].write_text(json.dumps(content))
        if "--report" in words:
            aims.append(settings["target_freq"])
        return options.get("patience") is None

    monkeypatch.setattr(nextpnr, "run_tool", run)
    (tmp_path / "netlist.json").write_text(json.dumps(PLACED))
    nextpnr.route(tmp_path, 1, True, (150, 140))
    assert aims == ["150000000.000000", "140000000.000000", "140000000.000000"]
