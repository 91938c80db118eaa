# SPDX-License-Identifier: Apache-2.0
"""How far a result lies above chance: a search without a match must not look like one that found its place."""

import numpy as np
import pytest

from golden.params import NO_SCORE
from signum import Job, Measurer, Query, Reason, Rules, Status, locate_peaks, open_board, run_jobs
from signum.common.arrays import Image

SIZE = 320, 240
NOT_CHANCE = 6.0


def _noise(seed: int) -> Image:
    return np.random.default_rng(seed).integers(0, 256, SIZE[::-1], dtype=np.uint8)


@pytest.mark.parametrize(("sigma", "window"), [(1.0, 16), (2.5, 32), (2.5, 64), (4.0, 64)])
def test_a_search_that_never_left_chance(sigma: float, window: int) -> None:
    with open_board("golden") as board:
        board.configure(SIZE, sigma)
        for slot in range(2):
            board.capture(slot, _noise(slot))
        places = [(x, y) for y in (0, 60, 120) for x in range(0, 200, 40)]
        peaks = []
        for template in (0, 1):
            jobs = [Job(template, x + 16, y + 16, window, window, 1, x, y, 33, 33) for x, y in places]
            peaks.append(locate_peaks(jobs, run_jobs(board, jobs), board.sigma))
    chance, found = peaks
    best = [peak.above_chance for peak in chance]
    print(f"sigma {sigma:g}, {window}x{window}: chance {min(best):.1f} to {max(best):.1f}, mean {np.mean(best):.1f}; "
          f"identical {min(p.above_chance for p in found):.1f}")
    assert 2.0 < np.mean(best) < 4.5 and max(best) < NOT_CHANCE < min(p.above_chance for p in found)


def test_single_scores_spread_by_one() -> None:
    """A chance score has standard deviation 1, and mean 0, in these units."""
    with open_board("golden") as board:
        board.configure(SIZE, 2.0)
        for slot in range(2):
            board.capture(slot, _noise(10 + slot))
        jobs = [Job(0, x, y, 32, 32, 1, x, y, 1, 1) for y in range(0, 208, 4) for x in range(0, 288, 4)]
        scores = np.array([r.above_chance(j, 2.0) for j, r in zip(jobs, run_jobs(board, jobs), strict=True)])
    assert abs(scores.std() - 1) < 0.15 and abs(scores.mean()) < 0.4


def test_a_measurement_has_it_whether_valid_or_not() -> None:
    with open_board("golden") as board:
        measurer = Measurer(board, SIZE, 2.5, Rules(texture=False, backward=False))
        a, b = measurer.view(_noise(1)), measurer.view(_noise(2))
        good, bad, outside = measurer.measure([Query(a, a, 100, 100, 64, 64), Query(a, b, 100, 100, 64, 64),
                                               Query(a, b, 0, 0, 64, 64)])
    assert good.valid and good.above_chance == pytest.approx(64 / (1.1 * 2.5))
    assert not bad.valid and bad.reason is Reason.SCORE and 1 < bad.above_chance < NOT_CHANCE
    assert outside.above_chance == 0.0


def test_the_patch_is_in_the_order_of_the_surface() -> None:
    with open_board("golden") as board:
        board.configure(SIZE, 2.5)
        board.capture(0, _noise(3))
        inside, corner = Job(0, 40, 50, 32, 32, 0, 35, 46, 11, 9), Job(0, 40, 50, 32, 32, 0, 40, 50, 5, 5)
        result, surface = board.surface(inside)
        assert np.array_equal(result.patch, surface[result.best_y - 1:result.best_y + 2,
                                                    result.best_x - 1:result.best_x + 2])
        patch = run_jobs(board, [corner])[0].patch
        assert (patch[0] == NO_SCORE).all() and (patch[:, 0] == NO_SCORE).all() and patch[1, 1] == 32 * 32
        (refused,) = run_jobs(board, [Job(0, 0, 0, 32, 32, 5, 0, 0, 1, 1)])
    assert refused.status is Status.BAD_SLOT and refused.above_chance(corner, 2.5) == 0.0
