# SPDX-License-Identifier: Apache-2.0
"""Sites for block RAMs and multipliers of an ECP5-85, chosen before nextpnr places the rest.

nextpnr's analytic placer moves these two kinds to free sites only after it has placed all else. On a board that takes
nearly all of them they end far from their best places, and the total wire length nearly doubles. Here they get their
sites from a global placement of their own (`sim.synth.spread`). The floorplans of the two boards are kept in
`floorplans/`, so that place and route give the same result on every machine.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.optimize import linear_sum_assignment

from sim.synth.netlist import flat
from sim.synth.spread import BINS, HEIGHT, WIDTH, Charges, Indices, Vector, Wires, spread

GROUPS = (4, 13, 22, 31, 40, 49, 58, 69, 78, 87, 96, 105, 114)
"""Columns at which groups of four block RAMs and of four multipliers begin."""
BLUR = 2.0
"""Standard deviation in bins over which a kind's sites are spread as its capacity: they lie in few rows."""
ROOM = 11
"""Cells that a tile holds, of its sixteen look-up tables and flip-flops; the tiles' remaining room is held free."""
STARTS = 8
"""Floorplans of which the best is taken: their costs differ by a third."""
MOST_PINS = 300
"""Nets of more pins (clock, reset) do not influence the places of cells."""


@dataclass(frozen=True)
class Site:
    """A place for one block: tile column and row, and nextpnr's name."""

    x: int
    y: int
    bel: str


SITES = {
    "DP16KD": [Site(x + 2 * k, y, f"X{x + 2 * k}/Y{y}/EBR{k}")
               for y in (22, 46, 70, 82) for x in GROUPS for k in range(4)],
    "MULT18X18D": [Site(x + k, y, f"X{x + k}/Y{y}/MULT18_{k}")
                   for y in (10, 34, 58) for x in GROUPS for k in (0, 1, 4, 5)],
}


def _nets(cells: Sequence[Mapping[str, Any]]) -> list[list[int]]:
    """For every net between cells, the numbers of its cells."""
    users: dict[int, set[int]] = {}
    for number, cell in enumerate(cells):
        for bits in cell["connections"].values():
            for bit in bits:
                if isinstance(bit, int):
                    users.setdefault(bit, set()).add(number)
    return [sorted(u) for u in users.values() if 1 < len(u) < MOST_PINS]


def _assigned(x: Vector, y: Vector, sites: Sequence[Site]) -> Indices:
    """For each block a site of its own near its place x, y: the sum of the displacements to the power 2.5 is least."""
    at = np.array([(s.x, s.y) for s in sites], np.float64)
    cost = np.abs(x[:, None] - at[:, 0]) + np.abs(y[:, None] - at[:, 1])
    chosen: Indices = linear_sum_assignment(cost**2.5)[1]
    return chosen


def floorplan(cells: Mapping[str, Mapping[str, Any]], seed: int = 0) -> tuple[dict[str, str], float]:
    """Choose sites.

    Args:
        cells: of a flat netlist, as Yosys writes it: `type`, and `connections` from pin to nets' numbers.
        seed: of the first places of all cells.

    Returns:
        Site by cell, for every block RAM and multiplier; the wires' cost with the blocks on these sites.

    Raises:
        ValueError: there are more of them than sites.
    """
    names, number = list(cells), len(cells)
    blocks = {kind: np.array([i for i, name in enumerate(names) if cells[name]["type"] == kind], np.intp)
              for kind in SITES}
    for kind, members in blocks.items():
        if len(members) > len(SITES[kind]):
            raise ValueError(f"{len(members)} {kind}, but the device has {len(SITES[kind])}")
    nets = _nets(list(cells.values()))
    blocks = {kind: members for kind, members in blocks.items() if len(members)}
    if not blocks or not nets:
        return {}, 0.0
    logic = np.setdiff1d(np.arange(number), np.concatenate(list(blocks.values())))
    free = min(max(WIDTH * HEIGHT * ROOM - len(logic), 0), 2 * len(logic))
    kinds = [Charges(np.concatenate([logic, np.arange(number, number + free)]), np.ones((BINS, BINS)))]
    for kind, members in blocks.items():
        capacity = np.zeros((BINS, BINS))
        for site in SITES[kind]:
            capacity[site.x * BINS // WIDTH, site.y * BINS // HEIGHT] += 1
        kinds.append(Charges(members, gaussian_filter(capacity, BLUR, mode="nearest")))
    wires = Wires.of(nets)
    place = spread(wires, number, kinds, seed)[:, :number]
    chosen = {}
    for kind, members in blocks.items():
        sites = [SITES[kind][k] for k in _assigned(place[0, members], place[1, members], SITES[kind])]
        place[:, members] = np.array([(site.x, site.y) for site in sites]).T
        chosen.update({names[member]: site.bel for member, site in zip(members, sites, strict=True)})
    return chosen, wires.cost(place)


def best_floorplan(cells: Mapping[str, Mapping[str, Any]], starts: int = STARTS) -> dict[str, str]:
    """The cheapest of `starts` floorplans; arguments and result as for `floorplan`.

    The floorplan of a start depends on rounding errors, and so on the processor.
    """
    best: dict[str, str] = {}
    least = np.inf
    with ThreadPoolExecutor(os.cpu_count()) as workers:
        for seed, (chosen, cost) in enumerate(workers.map(floorplan, repeat(cells), range(starts))):
            print(f"  floorplan {seed + 1} of {starts}: cost {cost:.0f}", flush=True)
            if cost < least:
                best, least = chosen, cost
    return best


def constrain(path: Path, kept: Path) -> None:
    """Give the blocks of a netlist their sites for nextpnr.

    Args:
        path: the netlist, as `sim.synth` wrote it; the sites are added.
        kept: a floorplan that `keep` wrote; if it is missing or of other blocks, one is searched for.
    """
    design = json.loads(path.read_text())
    cells = flat(design)["cells"]
    sites = json.loads(kept.read_text()) if kept.exists() else {}
    ours = {name: cell["type"] for name, cell in cells.items() if cell["type"] in SITES}
    theirs = {name: _kind(bel) for name, bel in sites.items()}
    if theirs != ours:
        print(f"  {kept.name} is not of these blocks: searching for a floorplan\n"
              "  (if a block was only renamed, rename it there instead and start again)", flush=True)
        for title, names in (("without a site", ours.items() - theirs.items()),
                             ("not in the netlist", theirs.items() - ours.items())):
            print(f"    {len(names)} {title}: {', '.join(name for name, _ in sorted(names)[:4])}", flush=True)
        sites = best_floorplan(cells)
    for name, bel in sites.items():
        cells[name].setdefault("attributes", {})["BEL"] = bel
    path.write_text(json.dumps(design))


def keep(path: Path, kept: Path, starts: int) -> None:
    """Search for a floorplan of the netlist at `path`, and write it to `kept`: site by cell, as JSON."""
    sites = best_floorplan(flat(json.loads(path.read_text()))["cells"], starts)
    kept.parent.mkdir(exist_ok=True)
    kept.write_text(json.dumps(sites, indent=0) + "\n")


def _kind(bel: str) -> str:
    return "MULT18X18D" if "MULT18" in bel else "DP16KD"
