# SPDX-License-Identifier: Apache-2.0
"""Floorplan of block RAMs and multipliers on small netlists."""

import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.synth.floorplan import SITES, best_floorplan, constrain, floorplan, keep
from sim.synth.flow import FLOORPLANS
from sim.synth.spread import LONG, Wires

AT = {site.bel: (site.x, site.y) for sites in SITES.values() for site in sites}


def _clusters(count: int, rams: int, logic: int) -> dict[str, Any]:
    """Clusters of look-up tables that read one another, and block RAMs that read them; one wire joins two clusters."""
    rng = np.random.default_rng(3)
    cells: dict[str, Any] = {}
    for c in range(count):
        first = 2 + c * logic
        for k in range(logic):
            read = (first + rng.integers(0, logic, 3)).tolist()
            cells[f"{c}.lut{k}"] = {"type": "LUT4", "connections": {"A": read[:1], "B": read[1:2], "C": read[2:],
                                                                    "Z": [first + k]}}
        cells[f"{c}.lut0"]["connections"]["D"] = [first - 1 if c else first]
        for r in range(rams):
            cells[f"{c}.ram{r}"] = {"type": "DP16KD", "connections": {
                f"DIA{k}": [int(bit)] for k, bit in enumerate(first + rng.integers(0, logic, 8))}}
    return cells


def test_blocks_get_sites_of_their_own_near_their_like() -> None:
    cells = _clusters(4, 12, 100)
    cells["mult"] = {"type": "MULT18X18D", "connections": {"A0": [5], "B0": ["0"]}}
    sites, cost = floorplan(cells)
    rams = {name for name in cells if "ram" in name}
    assert set(sites) == {*rams, "mult"} and len(set(sites.values())) == len(sites)
    assert sites["mult"] in {s.bel for s in SITES["MULT18X18D"]}
    assert {sites[name] for name in rams} <= {s.bel for s in SITES["DP16KD"]}

    def spread(names: list[str]) -> float:
        return float(np.mean(np.std([AT[sites[name]] for name in names], axis=0)))

    own = np.mean([spread([f"{c}.ram{r}" for r in range(12)]) for c in range(4)])
    assert own < 0.6 * spread(sorted(rams))
    assert floorplan(cells) == (sites, cost) and cost > 0


def test_wires_pull_as_their_cost_grows() -> None:
    """The cost of two nets, computed by hand, and its slope with the place of each cell."""
    at = np.array([[3.0, 40.0, 10.0, 90.0], [0.0, 0.0, 7.0, 7.0]])
    wires = Wires.of([[0, 1], [0, 2, 3]])
    lengths = [37.0, 87.0, 0.0, 7.0]
    assert wires.cost(at) == pytest.approx(sum(n + n**2 / (2 * LONG) for n in lengths))
    for cell, sign in ((1, 1), (3, 1), (0, -1), (2, 0)):
        moved = at.copy()
        moved[0, cell] += 1e-4
        slope = (wires.cost(moved) - wires.cost(at)) / 1e-4
        assert wires.pull(at[0], 0.5)[cell] == pytest.approx(slope, abs=1e-3)
        assert np.sign(slope) == sign


def test_more_blocks_than_sites_are_refused() -> None:
    cells = {f"m{k}": {"type": "MULT18X18D", "connections": {"A0": [2]}} for k in range(157)}
    with pytest.raises(ValueError, match="157 MULT18X18D, but the device has 156"):
        floorplan(cells)


def _netlist(path: Path, rams: int) -> Path:
    path.write_text(json.dumps({"modules": {"small": {"cells": {}}, "top": {"cells": _clusters(1, rams, 50)}}}))
    return path


def _sites(path: Path) -> dict[str, str]:
    cells = json.loads(path.read_text())["modules"]["top"]["cells"]
    assert all(("BEL" in cell.get("attributes", {})) == (cell["type"] == "DP16KD") for cell in cells.values())
    return {name: cell["attributes"]["BEL"] for name, cell in cells.items() if "attributes" in cell}


def test_netlist_carries_the_sites_that_are_kept(tmp_path: Path) -> None:
    kept = tmp_path / "kept" / "small.json"
    keep(_netlist(tmp_path / "netlist.json", 2), kept, 2)
    chosen = json.loads(kept.read_text())
    other = {**chosen, "0.ram0": next(s.bel for s in SITES["DP16KD"] if s.bel not in chosen.values())}
    for sites in (chosen, other):
        kept.write_text(json.dumps(sites))
        constrain(path := _netlist(tmp_path / "netlist.json", 2), kept)
        assert _sites(path) == sites


def test_without_sites_of_these_blocks_they_are_sought(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever is wrong with those that are kept; a single start each, as the best of several is another test's."""
    monkeypatch.setattr("sim.synth.floorplan.best_floorplan", partial(best_floorplan, starts=1))
    kept = tmp_path / "small.json"
    for text in (None, '{"0.ram0": "X6/Y22/EBR0"}', '{"0.ram0": "X6/Y22/EBR0", "0.ram1": "X4/Y10/MULT18_0"}'):
        if text is not None:
            kept.write_text(text)
        constrain(path := _netlist(tmp_path / "netlist.json", 2), kept)
        assert set(_sites(path).values()) <= {s.bel for s in SITES["DP16KD"]} and len(_sites(path)) == 2
        assert "small.json is not of these blocks" in capsys.readouterr().out


def test_a_renamed_block_is_named(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim.synth.floorplan.best_floorplan", lambda cells: {})
    kept = tmp_path / "small.json"
    kept.write_text('{"0.ram0": "X6/Y22/EBR0", "0.old": "X8/Y22/EBR1"}')
    constrain(_netlist(tmp_path / "netlist.json", 2), kept)
    said = capsys.readouterr().out
    assert "1 without a site: 0.ram1" in said and "1 not in the netlist: 0.old" in said


@pytest.mark.parametrize("config", ["full", "tiny"])
def test_kept_floorplans_give_each_block_a_site_of_its_own(config: str) -> None:
    sites = json.loads((FLOORPLANS / f"{config}.json").read_text()).values()
    assert len(sites) > 8 and len(set(sites)) == len(sites) and set(sites) <= set(AT)


def test_the_cheapest_of_several_starts_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    costs = (3.0, 1.0, 2.0)
    monkeypatch.setattr("sim.synth.floorplan.floorplan", lambda cells, seed: ({"start": str(seed)}, costs[seed]))
    assert best_floorplan({}, len(costs)) == {"start": "1"}
