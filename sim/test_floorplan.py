"""Floorplan of block RAMs and multipliers on small netlists."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.floorplan import LONG, SITES, Wires, constrain, floorplan

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
    cells = _clusters(4, 12, 300)
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
    """The cost of two nets by hand; each cell feels how it changes with its place."""
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


def test_netlist_carries_the_sites(tmp_path: Path) -> None:
    path = tmp_path / "netlist.json"
    path.write_text(json.dumps({"modules": {"small": {"cells": {}}, "top": {"cells": _clusters(1, 2, 50)}}}))
    constrain(path)
    cells = json.loads(path.read_text())["modules"]["top"]["cells"]
    assert all(("BEL" in cell.get("attributes", {})) == (cell["type"] == "DP16KD") for cell in cells.values())
