# SPDX-License-Identifier: Apache-2.0
"""A global placement: the wires pull, and cells of a kind repel one another like charges until each kind covers the
capacity that the device has for it (after Lu et al., "ePlace", ACM TODAES 20(2), 2015).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft

Vector = np.ndarray[tuple[int], np.dtype[np.float64]]
Plane = np.ndarray[tuple[int, int], np.dtype[np.float64]]
Indices = np.ndarray[tuple[int], np.dtype[np.intp]]

WIDTH, HEIGHT = 126, 95
"""Tiles of the device."""
SIZE = np.array([[WIDTH], [HEIGHT]], np.float64)
BINS = 64
"""Bins of the charges' grid along each side."""
LONG = 8
"""Length of a net along an axis, tiles, at which its pull is twice that of a short net. The longest nets decide the
clock, so they must pull harder."""
ITERATIONS = 1200
PUSH, CROWDED, FAR = 1.015, 0.07, 0.3
"""In each iteration the charge of the logic, and of every other kind with more than FAR of its cells beyond their bins'
capacity, is multiplied by PUSH. Iterations end when less than CROWDED of the logic is beyond it."""


@dataclass(frozen=True)
class Wires:
    """Nets as one list of pins: `cell` and `net` of each pin, and the `first` pin of each net."""

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
        """The cost that the wires' pull reduces."""
        return float(sum((length + length**2 / (2 * LONG)).sum() for length in map(self.extents, at)))

    def pull(self, at: Vector, smooth: float) -> Vector:
        """Derivative of the nets' cost along one axis by each cell's place, with the weighted-average model of extents.

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
    """Cells of one kind, which repel one another, on a plane whose capacity attracts them."""

    def __init__(self, members: Indices, capacity: Plane) -> None:
        """Take the cells' numbers, and the capacity of each bin, in any unit."""
        self.members = members
        self.capacity = capacity / capacity.sum()
        waves = [np.pi * np.arange(BINS) / length for length in (WIDTH, HEIGHT)]
        square = waves[0][:, None] ** 2 + waves[1] ** 2
        square[0, 0] = np.inf  # the mean charge has no field
        self.inverse = 1 / square

    def push(self, place: Plane) -> tuple[Plane, float]:
        """The force on each member along both axes, and the share of them beyond the capacity of their bins."""
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


@dataclass
class _Descent:
    """Nesterov's method for places within the device: the last places and the momentum, and the point ahead of them."""

    at: Plane
    ahead: Plane
    momentum: float = 1.0
    before: tuple[Plane, Plane] | None = None

    def step(self, slope: Plane) -> None:
        """Move against the slope at the point ahead; the length of the step follows from the slope's change."""
        if self.before is None:
            length = 0.5 / max(float(np.abs(slope).mean()), 1e-9)
        else:
            length = (float(np.linalg.norm(self.ahead - self.before[0]))
                      / max(float(np.linalg.norm(slope - self.before[1])), 1e-12))
        self.before = self.ahead, slope
        moved = np.clip(self.ahead - length * slope, 0, SIZE - 1e-3)
        faster = (1 + np.sqrt(4 * self.momentum**2 + 1)) / 2
        self.ahead = np.clip(moved + (self.momentum - 1) / faster * (moved - self.at), 0, SIZE - 1e-3)
        self.at, self.momentum = moved, faster


def spread(wires: Wires, cells: int, kinds: Sequence[Charges], seed: int) -> Plane:
    """Places of all cells, the first `cells` of them on wires: Nesterov's method on wires and charges together."""
    total = cells + sum(int(np.sum(kind.members >= cells)) for kind in kinds)
    rng = np.random.default_rng(seed)
    at = SIZE / 2 + rng.normal(0, 6, (2, total))
    at[:, cells:] = rng.uniform(0, 1, (2, total - cells)) * SIZE
    stiff = np.ones(total)
    stiff[:cells] = np.maximum(np.bincount(wires.cell, minlength=cells), 1)
    descent, crowd = _Descent(at, at), [1.0] * len(kinds)
    charge: list[float] = []
    for _ in range(ITERATIONS):
        smooth = float(np.clip(8 * 10 ** ((crowd[0] - 0.1) * 20 / 9 - 1), 0.5, 30))
        slope = np.zeros_like(at)
        for axis in range(2):
            slope[axis, :cells] = wires.pull(descent.ahead[axis, :cells], smooth)
        forces = []
        for k, kind in enumerate(kinds):
            force, crowd[k] = kind.push(descent.ahead)
            forces.append(force)
        if not charge:
            charge = [0.02 * np.abs(slope[:, kind.members]).sum() / max(np.abs(force).sum(), 1e-9)
                      for kind, force in zip(kinds, forces, strict=True)]
        for k, kind in enumerate(kinds):
            slope[:, kind.members] -= charge[k] * forces[k]
            if k == 0 or crowd[k] > FAR:
                charge[k] *= PUSH
        descent.step(slope / stiff)
        if crowd[0] < CROWDED:
            break
    return descent.at
