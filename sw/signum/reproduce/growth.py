# SPDX-License-Identifier: Apache-2.0
"""How the error at a survey's far corner grows with its size: chains of offsets as in the paper, and least squares.

    (a) sequential: the offsets along the way flown, m (m - 1) to m^2 - 1 of them between opposite corners;
    (b) adjacent columns: down the first column, then from column to column: 2 (m - 1);
    (c) least squares over all of them, rotation and zoom included.

(a) and (b) add up offsets as the paper does, with heading and height taken to be held. (c) is given no more: its plane,
which is the first frame's, is turned and scaled so that heading and height are held on average.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from signum.applications.mosaic.edges import LOOP, Edge
from signum.applications.mosaic.graph import chain, solve_graph
from signum.applications.mosaic.simulate import Cell, Flown, Plan, back_and_forth
from signum.common.arrays import Floats
from signum.geometry.similarity import IDENTITY
from signum.measure.register import Registrar

METHODS = "a", "b", "c"
GRID_REACH = 28
"""Search range around the planned offset, pixels of the board: several times the wobble."""


@dataclass(frozen=True, eq=False)
class MeasuredGrid:
    """The edges of a grid, between neighbours along columns and across.

    Attributes:
        edges: by the cells (a, b), accepted ones.
        refused: number of the others.
        errors: (n, 2) pixels, of the edges' offsets at a's centre against the truth.
    """

    edges: dict[tuple[Cell, Cell], Edge]
    refused: int
    errors: Floats


def cell_name(cell: Cell) -> str:
    """Name of the frame in a cell."""
    return f"{cell[0]},{cell[1]}"


def neighbour_cells(rows: int, columns: int) -> Iterator[tuple[Cell, Cell]]:
    """Pairs of cells side by side."""
    for r in range(rows):
        for c in range(columns):
            if r + 1 < rows:
                yield (r, c), (r + 1, c)
            if c + 1 < columns:
                yield (r, c), (r, c + 1)


def measure_grid(flown: Flown, registrar: Registrar, tell: Callable[[str], None] = lambda _: None) -> MeasuredGrid:
    """Measure all edges of a survey between neighbours."""
    plan = flown.plan
    centre = float(registrar.centre[0]), float(registrar.centre[1])
    prepared = {cell: registrar.prepare(frame) for cell, frame in flown.frames.items()}
    edges, errors, refused = {}, [], 0
    for a, b in neighbour_cells(plan.rows, plan.columns):
        result = registrar.register(prepared[a], prepared[b], plan.planned(a, b), GRID_REACH)
        if not result.accepted:
            refused += 1
            continue
        edges[a, b] = Edge.of(cell_name(a), cell_name(b), LOOP, centre, result)
        true = (flown.truth[b].inverse @ flown.truth[a])(registrar.centre)
        errors.append(result.similarity(registrar.centre) - true)
        tell(f"{a} to {b}")
    return MeasuredGrid(edges, refused, np.array(errors))


def corner_errors(flown: Flown, measured: MeasuredGrid, side: int, corner: int) -> dict[str, complex] | None:
    """Error of the far corner's place against the first one's, pixels, by method.

    Args:
        flown, measured: a survey larger than what is wanted.
        side: m; the m x m frames in one corner of the survey are used.
        corner: which, 0..3; the way begins there.

    Returns:
        None where a chain needs an edge that was refused.
    """
    rows, columns = flown.plan.rows, flown.plan.columns

    def at(cell: Cell) -> Cell:
        r, c = cell
        return (rows - 1 - r if corner & 1 else r), (columns - 1 - c if corner & 2 else c)

    way = [at(cell) for cell in back_and_forth(side, side)]
    first, far = at((0, 0)), at((side - 1, side - 1))
    truth = flown.position(far) - flown.position(first)
    sequential = list(pairwise(way))[: way.index(far)]
    down = [at((r, 0)) for r in range(side)] + [at((side - 1, c)) for c in range(1, side)]
    sums = {"a": _offsets(measured, sequential), "b": _offsets(measured, list(pairwise(down)))}
    if any(value is None for value in sums.values()):
        return None
    inside = set(way)
    edges = [edge for (a, b), edge in measured.edges.items() if a in inside and b in inside]
    found = _least_squares(flown.plan, edges, way)
    return {**{k: v - truth for k, v in sums.items() if v is not None}, "c": found[far] - found[first] - truth}


def _offsets(measured: MeasuredGrid, way: Sequence[tuple[Cell, Cell]]) -> complex | None:
    """Sum of the offsets along a way; b lies where a's centre lands, the other way round."""
    total = 0j
    for a, b in way:
        if (a, b) in measured.edges:
            total -= complex(*measured.edges[a, b].shift)
        elif (b, a) in measured.edges:
            total += complex(*measured.edges[b, a].shift)
        else:
            return None
    return total


def _least_squares(plan: Plan, edges: Sequence[Edge], cells: Sequence[Cell]) -> dict[Cell, complex]:
    """Centres of the frames, pixels, by all edges; heading and height held on average."""
    size = plan.size
    start = chain(cell_name(cells[0]), edges)
    places = solve_graph(cell_name(cells[0]), edges, size, start or {cell_name(cells[0]): IDENTITY}).places
    factors = np.array([places[cell_name(cell)].factor for cell in cells])
    mean = np.exp(np.mean(np.log(np.abs(factors)))) * np.exp(1j * np.angle(np.mean(factors / np.abs(factors))))
    middle = complex(*((n - 1) / 2 for n in size))
    placed = {cell: places[cell_name(cell)] for cell in cells}
    return {cell: complex((place.factor * middle + place.shift) / mean) for cell, place in placed.items()}
