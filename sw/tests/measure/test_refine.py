# SPDX-License-Identifier: Apache-2.0
"""The closer look's fit: relief displaces windows along the baseline, and is not taken for a turn."""

import numpy as np
import pytest

from signum.common.arrays import Floats
from signum.geometry.similarity import Similarity, least_squares
from signum.measure.refine import baseline, refine

SIZE = 400, 270


def _grid() -> Floats:
    """Centres of 12 by 8 windows, pixels."""
    x, y = np.meshgrid(np.arange(12) * 32.0 + 32, np.arange(8) * 32.0 + 32)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def test_a_shear_is_told_from_a_rotation() -> None:
    """Windows on a floor that leans, some of a boulder: the similarity without what the slope adds along the baseline,
    and the shear of the floor."""
    rng, p = np.random.default_rng(31), _grid()
    factor, shear = Similarity.of(3.0, 1.02).factor, 0.008 + 0.012j
    z = (p - p.mean(axis=0)) @ np.array([1, 1j])
    w = factor * z + shear * z.conj() + complex(200, 150) + rng.normal(0, 0.4, (len(z), 2)) @ np.array([1, 1j])
    w[:20] += 9
    q = np.stack([w.real, w.imag], axis=1)
    start = Similarity.of(2.0, 1.0, (200.0 - p[:, 0].mean(), 150.0 - p[:, 1].mean()))
    found = refine(p, q, start, 1.0, SIZE)
    way, _ = baseline(start, (199.5, 134.5))
    assert abs(found.similarity.factor - (factor - way**2 * shear.conjugate())) < 0.003
    assert abs(found.shear - shear) < 4 * found.shear_error < 0.04
    assert not found.agree[:20].any() and found.agree[20:].mean() > 0.9
    line = refine(p[:12], q[:12], found.similarity, 1.0, SIZE)
    assert line.shear == 0 and line.shear_error == float("inf"), "windows in a row show no shear"


def _relief(seed: int, slope: complex, rough: float, way: complex) -> tuple[Floats, Floats, Similarity]:
    """Windows of a level pair that is turned by 4 degrees and moved by 110 pixels, over relief: a slope, pixels per
    pixel, and steps of `rough` pixels, standard deviation. Windows are measured with errors of 0.4 pixels each way."""
    rng, p = np.random.default_rng(seed), _grid()
    z = p @ np.array([1, 1j])
    middle = z.mean()
    true = Similarity.of(4.0, 0.98)
    true = Similarity(true.factor, middle + 110 * way - true.factor * middle)
    depth = np.repeat(np.repeat(rng.normal(0, rough, (4, 6)), 2, axis=0), 2, axis=1).ravel()
    high = ((slope.conjugate() * (z - middle)).real + depth) * way
    w = true.factor * z + true.shift + high + rng.normal(0, 0.4, (len(z), 2)) @ np.array([1, 1j])
    return p, np.stack([w.real, w.imag], axis=1), true


@pytest.mark.parametrize("way", [1 + 0j, 1j, (1 + 1j) / np.sqrt(2)])
def test_relief_turns_no_pair(way: complex) -> None:
    """A floor that slopes by 8 degrees and is rough: rotation and scale of the pair, and where windows lie across the
    baseline, are those of the cameras. A similarity alone is off by 0.02, one beside a free shear by the same."""
    off, across = [], []
    for seed in range(8):
        p, q, true = _relief(seed, 0.04 * np.exp(2j * np.pi * seed / 8), 2.0, way)
        start = Similarity(true.factor * Similarity.of(0.5).factor, true.shift)
        start = Similarity(start.factor, true.factor * 200 + true.shift - start.factor * 200)
        found = refine(p, q, start, 1.0, SIZE).similarity
        off.append(abs(found.factor - true.factor))
        at = complex(*p.mean(axis=0))
        across.append(abs(((found.factor * at + found.shift - true.factor * at - true.shift) / way).imag))
        assert abs(least_squares(p, q).factor - true.factor) > 0.012
    print(f"rotation and scale off by {np.max(off):.4f} at most, {np.mean(off):.4f} in the mean; across by "
          f"{np.max(across):.2f} px")
    assert np.max(off) < 0.003 and np.max(across) < 0.2


def test_windows_may_miss_along_the_baseline_only() -> None:
    p, q, true = _relief(3, 0j, 0.0, 1j)
    q[0:96:8] += (0.0, 2.2)
    q[4:96:8] += (2.2, 0.0)
    agree = refine(p, q, true, 1.0, SIZE).agree
    assert agree[0:96:8].mean() > 0.8 and not agree[4:96:8].any() and agree[2:96:8].mean() > 0.9


def test_a_camera_that_stands_still_sees_no_slope() -> None:
    """Without a baseline height displaces nothing, so rotation and scale are those of the windows."""
    rng, p = np.random.default_rng(5), _grid()
    true = Similarity.of(3.0, 1.01)
    centre = 199.5 + 134.5j
    true = Similarity(true.factor, centre - true.factor * centre)
    found = refine(p, true(p) + rng.normal(0, 0.4, p.shape), true, 1.0, SIZE)
    assert abs(found.similarity.factor - true.factor) < 0.001
