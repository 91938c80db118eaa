# SPDX-License-Identifier: Apache-2.0
"""The pose graph: known graphs are recovered, even with some wrong edges."""

import numpy as np
import pytest

from signum.applications.mosaic.edges import LOOP, Edge
from signum.applications.mosaic.graph import FLOOR_PX, PARALLAX, TOGETHER, chain, solve_graph
from signum.geometry.similarity import Similarity

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


def test_only_what_hangs_together_is_placed() -> None:
    rng = np.random.default_rng(3)
    poses = _poses(3, rng)
    solution = solve_graph("0", [_edge(poses, "0", "1", rng, 1.0), _edge(poses, "4", "5", rng, 1.0)], SIZE)
    assert set(solution.places) == {"0", "1"} and solution.usual == 1
    assert set(solve_graph("8", [], SIZE).places) == {"8"}
