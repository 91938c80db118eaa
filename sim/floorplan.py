"""Sites for block RAMs and multipliers of an ECP5-85, chosen before nextpnr places the rest.

nextpnr's analytic placer moves these two kinds to free sites only when all else has found its place. On a board that
takes nearly all of them they end far from where they were wanted, and all wires together become nearly twice as long.
Here they get their sites from a global placement of its own: cells joined by springs, pulled apart in turns until
they cover the device, block RAMs and multipliers each time towards the sites nearest in sum (after Kim, Lee and Markov,
"SimPL: an effective placement algorithm", ICCAD 2010).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sparse
from scipy.optimize import linear_sum_assignment
from scipy.sparse.linalg import cg

Vector = np.ndarray[tuple[int], np.dtype[np.float64]]
Indices = np.ndarray[tuple[int], np.dtype[np.intp]]

WIDTH, HEIGHT = 126, 95
"""Tiles of the device."""
GROUPS = (4, 13, 22, 31, 40, 49, 58, 69, 78, 87, 96, 105, 114)
"""Columns at which groups of four block RAMs and of four multipliers begin."""
ROUNDS = 20
SLABS = 24
MOST_PINS = 300
"""Nets of more pins (clock, reset) say nothing about where a cell belongs."""
PULL = 0.004
"""A cell's pull towards its last place, in shares of its springs', after one round; it grows each round, and is three
times that for blocks."""


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


def _springs(nets: Sequence[Sequence[int]], cells: int) -> sparse.csr_matrix:
    """Stiffness between every cell and its nets' centres, which are numbered behind the cells."""
    pin = np.concatenate([np.asarray(net, np.intp) for net in nets])
    size = np.array([len(net) for net in nets])
    centre = np.repeat(np.arange(len(nets)) + cells, size)
    weight = np.repeat(1 / np.sqrt(size), size)
    total = cells + len(nets)
    one_way = sparse.coo_matrix((weight, (pin, centre)), (total, total))
    return sparse.csr_matrix(one_way + one_way.T)


def _apart(along: Vector, across: Vector, length: float) -> Vector:
    """`along`, in slabs of equal number by `across` moved half-way to where each cell of a slab has the same room."""
    moved = along.copy()
    for slab in np.array_split(np.argsort(across, kind="stable"), SLABS):
        order = slab[np.argsort(along[slab], kind="stable")]
        moved[order] = (along[order] + (np.arange(len(order)) + 0.5) / max(len(order), 1) * length) / 2
    return moved


def _assigned(x: Vector, y: Vector, sites: Sequence[Site]) -> Indices:
    """For each block wanted at x, y a site of its own, the displacements small in sum."""
    at = np.array([(s.x, s.y) for s in sites], np.float64)
    cost = np.abs(x[:, None] - at[:, 0]) + np.abs(y[:, None] - at[:, 1])
    chosen: Indices = linear_sum_assignment(cost**1.5)[1]
    return chosen


def floorplan(cells: Mapping[str, Mapping[str, Any]], seed: int = 0) -> dict[str, str]:
    """Choose sites.

    Args:
        cells: of a flat netlist, as Yosys writes it: `type`, and `connections` from pin to nets' numbers.
        seed: of the places all begin at.

    Returns:
        Site by cell, for every block RAM and multiplier.

    Raises:
        ValueError: there are more of them than sites.
    """
    names, number = list(cells), len(cells)
    kinds = {kind: np.array([i for i, name in enumerate(names) if cells[name]["type"] == kind], np.intp)
             for kind in SITES}
    for kind, members in kinds.items():
        if len(members) > len(SITES[kind]):
            raise ValueError(f"{len(members)} {kind}, but the device has {len(SITES[kind])}")
    blocks = np.concatenate(list(kinds.values()))
    nets = _nets(list(cells.values()))
    if not len(blocks) or not nets:
        return {}
    others = np.setdiff1d(np.arange(number), blocks)
    pins, first = np.concatenate([np.asarray(net, np.intp) for net in nets]), np.cumsum([0, *map(len, nets[:-1])])
    springs = _springs(nets, number)
    degree = np.maximum(np.asarray(springs.sum(axis=1)).ravel(), 1e-3)
    pull = degree[:number] * PULL
    pull[blocks] *= 3

    rng = np.random.default_rng(seed)
    size = np.array([WIDTH, HEIGHT], np.float64)
    place = size[:, None] / 2 + rng.normal(0, 5, (2, len(degree)))
    wanted = place[:, :number].copy()
    best, sites = np.inf, {}
    for turn in range(ROUNDS):
        anchor = np.zeros_like(degree)
        anchor[:number] = pull * max(turn, 0.01)
        system = sparse.csr_matrix(sparse.diags(degree + anchor) - springs)
        inverse = sparse.diags(1 / (degree + anchor))
        for axis in range(2):
            target = np.zeros_like(degree)
            target[:number] = wanted[axis]
            place[axis] = cg(system, anchor * target, x0=place[axis], M=inverse, maxiter=120, rtol=1e-4)[0]
        wanted = place[:, :number].copy()
        for axis in range(2):
            wanted[axis, others] = _apart(wanted[axis, others], wanted[1 - axis, others], size[axis])
            # Block RAMs and multipliers go with what lies beside them.
            wanted[axis, blocks] = np.interp(place[axis, blocks], np.sort(place[axis, others]),
                                             np.sort(wanted[axis, others]))
        found = {}
        for kind, members in kinds.items():
            chosen = _assigned(wanted[0, members], wanted[1, members], SITES[kind])
            for member, k in zip(members, chosen, strict=True):
                site = SITES[kind][k]
                found[names[member]] = site.bel
                wanted[:, member] = site.x, site.y
        reach = wanted[:, pins]
        length = float(np.sum(np.maximum.reduceat(reach, first, 1) - np.minimum.reduceat(reach, first, 1)))
        if length < best:
            best, sites = length, found
    return sites


def constrain(path: Path) -> None:
    """Give the blocks of the netlist at `path`, as `sim.synth` wrote it, their sites for nextpnr."""
    design = json.loads(path.read_text())
    cells = max((module["cells"] for module in design["modules"].values()), key=len)
    for name, bel in floorplan(cells).items():
        cells[name].setdefault("attributes", {})["BEL"] = bel
    path.write_text(json.dumps(design))
