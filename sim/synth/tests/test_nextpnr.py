# SPDX-License-Identifier: Apache-2.0
"""What is given to nextpnr."""

import json
from pathlib import Path
from typing import Any

import pytest

from sim.synth import nextpnr

Words = list[Any]


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[Words]:
    """The arguments of each run; the first router ends where the netlist is `easy`."""
    runs: list[Words] = []

    def run(name: str, log: Path, *args: Any, patience: int | None = None) -> bool:
        words = list(args)
        runs.append(words)
        ends = patience is None or "easy" in _after(words, "--json").read_text()
        for flag in ("--write", "--report"):
            if flag in words and ends:
                _after(words, flag).write_text(json.dumps({"fmax": 1}))
        return ends

    monkeypatch.setattr(nextpnr, "run_tool", run)
    return runs


def _after(words: Words, flag: str) -> Any:
    return words[words.index(flag) + 1]


def test_one_run_places_and_routes(tmp_path: Path, runs: list[Words]) -> None:
    (tmp_path / "netlist.json").write_text("easy")
    written = tmp_path / "routed.json"
    assert nextpnr.route(tmp_path, 7, True, 123.0, written) == {"fmax": 1, "router": nextpnr.ROUTERS[0]}
    (words,) = runs
    assert [_after(words, flag) for flag in ("--seed", "--freq", "--router", "--write")] == [
        "7", "123.0", nextpnr.ROUTERS[0], written]
    assert "--out-of-context" not in words and "--no-route" not in words


def test_the_second_router_takes_what_the_first_does_not_end(tmp_path: Path, runs: list[Words],
                                                             capsys: pytest.CaptureFixture[str]) -> None:
    """With the same seed and target, so that the placement is the same; and it is said."""
    (tmp_path / "netlist.json").write_text("tangled")
    assert nextpnr.route(tmp_path, 3, False, 150.0) == {"fmax": 1, "router": nextpnr.ROUTERS[1]}
    assert [_after(words, "--router") for words in runs] == list(nextpnr.ROUTERS)
    first, second = ([word for word in words if word not in nextpnr.ROUTERS] for words in runs)
    assert first == second and "--out-of-context" in first
    assert nextpnr.ROUTERS[1] in capsys.readouterr().out


def test_placed_only(tmp_path: Path, runs: list[Words]) -> None:
    (tmp_path / "netlist.json").write_text("easy")
    placed = nextpnr.place(tmp_path, 2, True, 150.0)
    assert placed.exists() and "--no-route" in runs[0] and "--router" not in runs[0]
