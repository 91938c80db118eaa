# SPDX-License-Identifier: Apache-2.0
"""The pose graph: known graphs are recovered, even with some wrong edges."""

from dataclasses import replace

import numpy as np
import pytest

from signum.applications.mosaic.edges import LOOP, Edge
from signum.applications.mosaic.graph import FLOOR_PX, PARALLAX, TOGETHER, chain, solve_graph
from signum.geometry.similarity import Similarity
from signum.measure.registration import UNKNOWN, Rival
from signum.measure.surface import settle

SIZE = 400, 300
CENTRE = (199.5, 149.5)


def _poses(side: int, rng: np.random.Generator) -> dict[str, Similarity]:
    """A grid of frames, turned and zoomed; the first is the identity."""
    out = {}
    for k in range(side * side):
        turn = Similarity.of(rng.normal(0, 4), float(np.exp(rng.normal(0, 0.03))))
        at = complex(200 * (k % side), 150 * (k // side)) + complex(*rng.normal(0, 10, 2))
        middle = complex(*CENTRE)
        out[str(k)] = Similarity() if k == 0 else Similarity(turn.factor, at + middle - turn.factor * middle)
    return out


def _edge(poses: dict[str, Similarity], a: str, b: str, rng: np.random.Generator, noise: float,
          relief: float = 0.0) -> Edge:
    """What a registration with window errors of `noise` pixels would give; 16 windows count as 4. Relief adds a share
    of the displacement."""
    true = poses[b].inverse @ poses[a]
    middle = (np.array(CENTRE) + true.inverse(np.array(CENTRE))) / 2
    spread = 60.0
    sigma = noise / np.sqrt(16 / TOGETHER)
    sigma = float(np.hypot(sigma, relief * np.hypot(*(true(np.array(CENTRE)) - np.array(CENTRE)))))
    factor = true.factor + complex(*rng.normal(0, sigma, 2)) / spread
    there = complex(*true(middle)) + complex(*rng.normal(0, sigma, 2))
    rms = float(np.sqrt(max(2 * (noise**2 - FLOOR_PX**2), 0)))
    return Edge(a, b, LOOP, Similarity(factor, there - factor * complex(*middle)), CENTRE,
                middle=(float(middle[0]), float(middle[1])), spread_px=spread, rms_px=rms, agreed=16, tried=20)


def _grid(side: int) -> list[tuple[str, str]]:
    return [(str(r * side + c), str(s * side + d)) for r in range(side) for c in range(side)
            for s, d in ((r, c + 1), (r + 1, c), (r + 1, c + 1)) if s < side and d < side]


def _errors(poses: dict[str, Similarity], found: dict[str, Similarity]) -> list[float]:
    return [float(np.hypot(*(found[n](np.array(CENTRE)) - poses[n](np.array(CENTRE))))) for n in poses]


def test_exact_edges_give_exact_poses() -> None:
    rng = np.random.default_rng(0)
    poses = _poses(5, rng)
    solution = solve_graph("0", [_edge(poses, a, b, rng, 0.0) for a, b in _grid(5)], SIZE)
    assert max(_errors(poses, solution.places)) < 1e-6
    for name, pose in poses.items():
        assert abs(solution.places[name].factor - pose.factor) < 1e-9
    assert solution.weights.min() > 0.999 and solution.misfit_px.max() < 1e-6


@pytest.mark.parametrize("seed", range(4))
def test_outliers_are_outvoted(seed: int) -> None:
    rng = np.random.default_rng(seed)
    poses = _poses(6, rng)
    edges = [_edge(poses, a, b, rng, 1.5) for a, b in _grid(6)]
    wrong = set(rng.choice(len(edges), len(edges) // 8, replace=False).tolist())
    for k in wrong:
        off = complex(*rng.uniform(30, 90, 2)) * rng.choice([1, -1])
        turned = edges[k].similarity @ Similarity.of(rng.uniform(-5, 5))
        edges[k] = Edge(**{**edges[k].__dict__, "similarity": Similarity(turned.factor, turned.shift + off)})
    solution = solve_graph("0", edges, SIZE)
    clean = solve_graph("0", [edge for k, edge in enumerate(edges) if k not in wrong], SIZE)
    assert max(solution.weights[k] for k in wrong) < 0.05
    assert np.mean([solution.weights[k] for k in range(len(edges)) if k not in wrong]) > 0.7
    apart = [np.hypot(*(solution.places[n](np.array(CENTRE)) - clean.places[n](np.array(CENTRE)))) for n in poses]
    assert max(apart) < 1.5, "as good as without them"
    assert max(_errors(poses, chain("0", edges))) > 1.5 * max(_errors(poses, solution.places)), "which a chain is not"


def test_deviation_is_what_is_seen() -> None:
    """The predicted standard deviation of a far frame's place against its scatter over trials."""
    poses = _poses(4, np.random.default_rng(1))
    misses, said = [], []
    for seed in range(40):
        rng = np.random.default_rng(100 + seed)
        solution = solve_graph("0", [_edge(poses, a, b, rng, 2.0, PARALLAX) for a, b in _grid(4)], SIZE)
        miss = solution.relative("0", "15")(np.array(CENTRE)) - (poses["15"].inverse @ poses["0"])(np.array(CENTRE))
        misses.append(miss)
        said.append(solution.deviation("0", "15", CENTRE))
    ratio = np.sqrt(np.mean(np.square(misses))) / np.sqrt(np.mean(np.square(said)))
    assert 0.6 < ratio < 1.3


def test_a_long_loop_does_not_shrink() -> None:
    """Edges that cannot agree must not be made to by making far frames small."""
    rng = np.random.default_rng(2)
    poses = _poses(7, rng)
    edges = [_edge(poses, a, b, rng, 6.0) for a, b in _grid(7)]
    scales = [p.scale / poses[n].scale for n, p in solve_graph("0", edges, SIZE).places.items()]
    assert abs(float(np.mean(np.log(scales)))) < 0.03


def _leaning(poses: dict[str, Similarity], a: str, b: str, lean: complex, rng: np.random.Generator) -> Edge:
    """What registration sees of a level floor from cameras that all lean: exact projection, 40 windows."""
    middle, true = complex(*CENTRE), poses[b].inverse @ poses[a]
    x, y = np.meshgrid(np.linspace(0, SIZE[0], 24), np.linspace(0, SIZE[1], 18))
    p = (x + 1j * y).ravel() - middle
    flat = true.factor * (p / (1 + (lean.conjugate() * p).real) + middle) + true.shift - middle
    q = flat / (1 - (lean.conjugate() * flat).real)
    both = (np.abs(q.real) < SIZE[0] / 2) & (np.abs(q.imag) < SIZE[1] / 2)
    q += rng.normal(0, 0.3, (len(q), 2)) @ np.array([1, 1j])
    seen = (np.stack([z.real, z.imag], axis=1) + CENTRE for z in (p[both], q[both]))
    here, there = seen
    found, sloping = settle(here, there, true, 1.0, SIZE)
    at = here[found.agree].mean(axis=0)
    spread = float(np.sqrt(((here[found.agree] - at) ** 2).sum(axis=1).mean()))
    return Edge(a, b, LOOP, found.similarity, CENTRE, middle=(float(at[0]), float(at[1])), spread_px=spread,
                rms_px=found.rms_px, agreed=20, tried=24, shear=(found.shear.real, found.shear.imag),
                shear_error=found.shear_error, sloping=sloping)


LEANS = [2e-4 + 0j, -2e-4j, 1e-4 + 1.5e-4j]
"""Of all frames, per pixel: five degrees at a focal length of 430 pixels, to the side, nose down, both."""


@pytest.mark.parametrize("lean", LEANS)
def test_a_leaning_vehicle_keeps_its_heading(lean: complex) -> None:
    """A similarity alone would turn by up to 0.7 degrees an edge, half the step times the lean."""
    rng = np.random.default_rng(41)
    poses = {str(k): Similarity.of(shift=(4.0 * (k % 2), -120.0 * k)) for k in range(8)}
    edges = [_leaning(poses, str(k), str(k + 1), lean, rng) for k in range(7)]
    solution = solve_graph("0", edges, SIZE)
    for turned in ([edge.similarity.rot_deg for edge in edges],
                   [solution.relative(str(k), str(k + 1)).rot_deg for k in range(7)]):
        assert abs(np.mean(turned)) < 0.05 and np.abs(turned).max() < 0.1


@pytest.mark.parametrize("lean", LEANS)
def test_columns_of_a_leaning_vehicle_lie_straight(lean: complex) -> None:
    """Edges of a leaning camera turn right by right, and grow: six columns do not fit together unless levelled."""
    rng = np.random.default_rng(47)
    poses = {str(k): Similarity.of(shift=(180.0 * (k % 6), 120.0 * (k // 6))) for k in range(36)}
    edges = [_leaning(poses, a, b, lean, rng) for a, b in _grid(6)]
    level = solve_graph("0", edges, SIZE)
    raw = solve_graph("0", [replace(edge, shear=(0.0, 0.0), shear_error=UNKNOWN) for edge in edges], SIZE)
    turned, grown = ([[float(np.abs(value).max()) for value in (
        [p.rot_deg for p in solution.places.values()], [np.log(p.scale) for p in solution.places.values()])][k]
        for solution in (level, raw)] for k in (0, 1))
    print(f"lean {lean}: turned by {turned[0]:.2f} degrees at most, raw {turned[1]:.2f}; scale off by {grown[0]:.3f}, "
          f"raw {grown[1]:.3f}; misfit {np.median(level.misfit_px):.2f}, raw {np.median(raw.misfit_px):.2f} px")
    assert turned[0] < 0.3 * turned[1] and grown[0] < 0.2 * grown[1]


def test_the_motion_that_the_others_bear_out_is_used() -> None:
    """Every fifth edge shows a boulder's motion, with the floor's as its rival; two have no rival and just lose."""
    rng = np.random.default_rng(43)
    poses = _poses(5, rng)
    edges = [_edge(poses, a, b, rng, 1.0) for a, b in _grid(5)]
    odd = list(range(2, len(edges), 5))
    clean = solve_graph("0", [edge for k, edge in enumerate(edges) if k not in odd[:2]], SIZE)
    for k in odd:
        e = edges[k]
        right = Rival(e.similarity, 0.8, 0.1, e.agreed, True, e.middle, e.spread_px, e.rms_px, 5.0)
        wrong = Similarity(e.similarity.factor, e.similarity.shift + 40 - 25j)
        edges[k] = replace(e, similarity=wrong, rivals=(right,) if k not in odd[:2] else ())
    solution = solve_graph("0", edges, SIZE)
    assert [k for k, number in enumerate(solution.chosen) if number] == odd[2:]
    assert max(_errors(clean.places, solution.places)) < 1, "as good as if all were right"
    assert max(solution.weights[k] for k in odd[:2]) < 0.05
    assert min(solution.weights[k] for k in odd[2:]) > 0.5
    back = edges[odd[2]].switched(1)
    assert back.similarity == edges[odd[2]].rivals[0].similarity and back.rivals[0].similarity == (
        edges[odd[2]].similarity)


def test_only_what_hangs_together_is_placed() -> None:
    rng = np.random.default_rng(3)
    poses = _poses(3, rng)
    solution = solve_graph("0", [_edge(poses, "0", "1", rng, 1.0), _edge(poses, "4", "5", rng, 1.0)], SIZE)
    assert set(solution.places) == {"0", "1"} and solution.usual == 1
    assert set(solve_graph("8", [], SIZE).places) == {"8"}
