"""Sites for block RAMs and multipliers of an ECP5-85, chosen before nextpnr places the rest.

nextpnr's analytic placer moves these two kinds to free sites only when all else has found its place. On a board that
takes nearly all of them they end far from where they were wanted, and all wires together become nearly twice as long.
Here they get their sites from a global placement of its own: the wires pull, and cells of a kind repel one another like
charges until each kind covers what the device has for it (after Lu et al., "ePlace", ACM TODAES 20(2), 2015).
The floorplans of the two boards are kept in `floorplans/`, so that place and route come out alike on every machine.
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
import scipy.fft
from scipy.ndimage import gaussian_filter
from scipy.optimize import linear_sum_assignment

Vector = np.ndarray[tuple[int], np.dtype[np.float64]]
Plane = np.ndarray[tuple[int, int], np.dtype[np.float64]]
Indices = np.ndarray[tuple[int], np.dtype[np.intp]]

WIDTH, HEIGHT = 126, 95
"""Tiles of the device."""
GROUPS = (4, 13, 22, 31, 40, 49, 58, 69, 78, 87, 96, 105, 114)
"""Columns at which groups of four block RAMs and of four multipliers begin."""
BINS = 64
"""Of the charges' grid, on each side."""
BLUR = 2.0
"""Standard deviation in bins of what a kind's sites count for around them: they lie in few rows."""
ROOM = 11
"""Cells that a tile holds, of its sixteen look-up tables and flip-flops: what is more than the board's is held free."""
LONG = 8
"""Tiles by which a net longer along an axis pulls as hard again: the longest decide the clock, and a knot in the wires
comes undone."""
STARTS = 8
"""Floorplans of which the best is taken: they differ by a third."""
TURNS = 1200
PUSH, CROWDED, FAR = 1.015, 0.07, 0.3
"""A kind's charge grows by PUSH each turn, while more than FAR of its cells, or CROWDED of the logic, have no place."""
MOST_PINS = 300
"""Nets of more pins (clock, reset) say nothing about where a cell belongs."""


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


@dataclass(frozen=True)
class Wires:
    """Nets as lists of cells, one behind the other: `cell` and `net` of each pin, and the `first` pin of each net."""

    cell: Indices
    net: Indices
    first: Indices

    @classmethod
    def of(cls, nets: Sequence[Sequence[int]]) -> Wires:
        """Wires of nets given by their cells."""
        sizes = [len(net) for net in nets]
        return cls(np.concatenate([np.asarray(net, np.intp) for net in nets]), np.repeat(np.arange(len(nets)), sizes),
                   np.cumsum([0, *sizes[:-1]]))

    def extents(self, at: Vector) -> Vector:
        """Length of each net along one axis, from the cells' places there."""
        pin = at[self.cell]
        length: Vector = np.maximum.reduceat(pin, self.first) - np.minimum.reduceat(pin, self.first)
        return length

    def cost(self, at: Plane) -> float:
        """What the wires' pull makes small."""
        return float(sum((length + length**2 / (2 * LONG)).sum() for length in map(self.extents, at)))

    def pull(self, at: Vector, smooth: float) -> Vector:
        """Growth of the nets' cost along one axis with each cell's place: of their extents the weighted-average model.

        Args:
            at: the cells' places, in tiles.
            smooth: tiles over which a net's outermost pins share its pull.
        """
        pin = at[self.cell]
        grown = np.zeros(len(pin))
        for side in (1, -1):
            x = side * pin
            weight = np.exp((x - np.maximum.reduceat(x, self.first)[self.net]) / smooth)
            total = np.add.reduceat(weight, self.first)
            mean = np.add.reduceat(weight * x, self.first) / total
            grown += side * weight * (1 + (x - mean[self.net]) / smooth) / total[self.net]
        grown *= 1 + self.extents(at)[self.net] / LONG
        slope: Vector = np.bincount(self.cell, grown, len(at)).astype(np.float64)
        return slope


class Charges:
    """Cells of one kind, which repel one another, on a plane with a capacity that attracts them."""

    def __init__(self, members: Indices, capacity: Plane) -> None:
        """Take the cells' numbers, and what each bin has room for, in any unit."""
        self.members = members
        self.capacity = capacity / capacity.sum()
        waves = [np.pi * np.arange(BINS) / length for length in (WIDTH, HEIGHT)]
        square = waves[0][:, None] ** 2 + waves[1] ** 2
        square[0, 0] = np.inf  # the mean charge has no field
        self.inverse = 1 / square

    def push(self, place: Plane) -> tuple[Plane, float]:
        """The force on each member along both axes, and the share of them that is where there is no room."""
        bins = np.clip(place[:, self.members] * [[BINS / WIDTH], [BINS / HEIGHT]] - 0.5, 0, BINS - 1.001)
        low = bins.astype(np.intp)
        part = bins - low
        corners = [(low[0] + i, low[1] + j, (part[0] if i else 1 - part[0]) * (part[1] if j else 1 - part[1]))
                   for i in (0, 1) for j in (0, 1)]
        charge = np.zeros(BINS * BINS)
        for column, row, weight in corners:
            charge += np.bincount(column * BINS + row, weight, BINS * BINS)
        excess = charge.reshape(BINS, BINS) / len(self.members) - self.capacity
        potential = scipy.fft.idctn(scipy.fft.dctn(excess, norm="ortho") * self.inverse, norm="ortho")
        field = np.gradient(potential, WIDTH / BINS, HEIGHT / BINS)
        force = np.array([-sum(weight * along[column, row] for column, row, weight in corners) for along in field])
        return force * len(self.members), float(np.maximum(excess, 0).sum())


def _assigned(x: Vector, y: Vector, sites: Sequence[Site]) -> Indices:
    """For each block wanted at x, y a site of its own, the displacements small in sum."""
    at = np.array([(s.x, s.y) for s in sites], np.float64)
    cost = np.abs(x[:, None] - at[:, 0]) + np.abs(y[:, None] - at[:, 1])
    chosen: Indices = linear_sum_assignment(cost**2.5)[1]
    return chosen


def _spread(wires: Wires, cells: int, kinds: Sequence[Charges], seed: int) -> Plane:
    """Places of all cells, the first `cells` of them on wires: Nesterov's method on wires and charges together."""
    total = cells + sum(int(np.sum(kind.members >= cells)) for kind in kinds)
    rng = np.random.default_rng(seed)
    size = np.array([[WIDTH], [HEIGHT]], np.float64)
    at = size / 2 + rng.normal(0, 6, (2, total))
    at[:, cells:] = rng.uniform(0, 1, (2, total - cells)) * size
    stiff = np.ones(total)
    stiff[:cells] = np.maximum(np.bincount(wires.cell, minlength=cells), 1)
    momentum, ahead, crowd = 1.0, at, [1.0] * len(kinds)
    charge: list[float] = []
    before: tuple[Plane, Plane] | None = None
    for _ in range(TURNS):
        smooth = float(np.clip(8 * 10 ** ((crowd[0] - 0.1) * 20 / 9 - 1), 0.5, 30))
        slope = np.zeros_like(at)
        for axis in range(2):
            slope[axis, :cells] = wires.pull(ahead[axis, :cells], smooth)
        forces = []
        for k, kind in enumerate(kinds):
            force, crowd[k] = kind.push(ahead)
            forces.append(force)
        if not charge:
            charge = [0.02 * np.abs(slope[:, kind.members]).sum() / max(np.abs(force).sum(), 1e-9)
                      for kind, force in zip(kinds, forces, strict=True)]
        for k, kind in enumerate(kinds):
            slope[:, kind.members] -= charge[k] * forces[k]
            if k == 0 or crowd[k] > FAR:
                charge[k] *= PUSH
        slope /= stiff
        if before is None:
            step = 0.5 / max(float(np.abs(slope).mean()), 1e-9)
        else:
            step = float(np.linalg.norm(ahead - before[0])) / max(float(np.linalg.norm(slope - before[1])), 1e-12)
        before = ahead, slope
        moved = np.clip(ahead - step * slope, 0, size - 1e-3)
        faster = (1 + np.sqrt(4 * momentum**2 + 1)) / 2
        ahead = np.clip(moved + (momentum - 1) / faster * (moved - at), 0, size - 1e-3)
        at, momentum = moved, faster
        if crowd[0] < CROWDED:
            break
    return at


def floorplan(cells: Mapping[str, Mapping[str, Any]], seed: int = 0) -> tuple[dict[str, str], float]:
    """Choose sites.

    Args:
        cells: of a flat netlist, as Yosys writes it: `type`, and `connections` from pin to nets' numbers.
        seed: of the places all begin at.

    Returns:
        Site by cell, for every block RAM and multiplier; the wires' cost with the blocks there.

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
    place = _spread(wires, number, kinds, seed)[:, :number]
    chosen = {}
    for kind, members in blocks.items():
        sites = [SITES[kind][k] for k in _assigned(place[0, members], place[1, members], SITES[kind])]
        place[:, members] = np.array([(site.x, site.y) for site in sites]).T
        chosen.update({names[member]: site.bel for member, site in zip(members, sites, strict=True)})
    return chosen, wires.cost(place)


def search(cells: Mapping[str, Mapping[str, Any]], starts: int = STARTS) -> dict[str, str]:
    """The cheapest of that many floorplans; arguments and result as `floorplan` has them.

    What a start leads to hangs on the last bits of its numbers, and so on the processor.
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
        kept: a floorplan made before, as `keep` writes it; where it is missing or of other blocks, one is searched for.
    """
    design = json.loads(path.read_text())
    cells = _largest(design)
    sites = json.loads(kept.read_text()) if kept.exists() else {}
    if {name: _kind(bel) for name, bel in sites.items()} != {
            name: cell["type"] for name, cell in cells.items() if cell["type"] in SITES}:
        print(f"  {kept.name} is not of these blocks: searching for a floorplan", flush=True)
        sites = search(cells)
    for name, bel in sites.items():
        cells[name].setdefault("attributes", {})["BEL"] = bel
    path.write_text(json.dumps(design))


def keep(path: Path, kept: Path, starts: int) -> None:
    """Search for a floorplan of the netlist at `path`, and write it to `kept`: site by cell, as JSON."""
    sites = search(_largest(json.loads(path.read_text())), starts)
    kept.parent.mkdir(exist_ok=True)
    kept.write_text(json.dumps(sites, indent=0) + "\n")


def _largest(design: Mapping[str, Any]) -> dict[str, Any]:
    """Cells of the largest module: the flat netlist."""
    return max((module["cells"] for module in design["modules"].values()), key=len)


def _kind(bel: str) -> str:
    return "MULT18X18D" if "MULT18" in bel else "DP16KD"
