# SPDX-License-Identifier: Apache-2.0
"""The distance that a pair of cameras states: the middle's median, its error, and none of too little."""

import numpy as np
import pytest

from signum.applications.mavlink.distance import LEAST_WINDOWS, DistanceSink, middle_distance

from .ends import receiver


def test_the_distance_is_the_middles_median_with_its_error() -> None:
    rng = np.random.default_rng(3)
    found = []
    for _ in range(300):
        depth = np.full((16, 24), 9.0)
        depth[4:12, 6:18] = rng.normal(2.0, 0.1, (8, 12))
        depth[5, 7:17] = np.nan
        one = middle_distance(depth)
        assert one is not None and one.share == pytest.approx(86 / 96)
        found.append(one)
    scatter = np.std([f.metres for f in found])
    assert np.mean([f.metres for f in found]) == pytest.approx(2.0, abs=0.003)
    assert np.mean([f.error for f in found]) == pytest.approx(scatter, rel=0.15)


def test_too_few_windows_have_no_distance() -> None:
    depth = np.full((8, 8), np.nan)
    depth[:2], depth[6:] = 1.0, 1.0
    assert middle_distance(depth) is None
    depth[3, 2:2 + LEAST_WINDOWS] = 3.0
    assert middle_distance(depth) == (3.0, 0.0, 0.25)


@pytest.mark.parametrize(("facing", "orientation"), [("down", 25), ("forward", 0)])
def test_a_distance_is_told_twenty_times_a_second_with_its_direction_and_what_it_can_be(facing: str, orientation: int
                                                                                       ) -> None:
    with receiver() as other, DistanceSink(other.address, facing, (0.413, 2000.0), (0.5, 0.4)) as sink:
        for k in range(31):
            sink.send(k / 30, np.full((8, 8), 1.234 if k != 15 else np.nan))
        got = other.heard("DISTANCE_SENSOR", sink.sent)
    assert {(g.current_distance, g.orientation, g.covariance, g.signal_quality) for g in got} == {
        (123, orientation, 1, 100)}
    assert (got[0].min_distance, got[0].max_distance) == (42, 65535), "what the message can hold"
    times = [g.time_boot_ms for g in got]
    assert 19 <= len(times) <= 22 and len(set(times)) == len(times)
