# SPDX-License-Identifier: Apache-2.0
"""Times of frames: the source's own, made to advance; a rate only where there are none."""

import numpy as np
import pytest

from signum.frames.clock import timed
from signum.frames.frame import Frame

PICTURE = np.zeros((8, 8), np.uint8)


def times(given: list[float | None], rate: float | None = None) -> list[float | None]:
    return [f.time_s for f in timed([Frame(str(k), PICTURE, t) for k, t in enumerate(given)], "dive", rate)]


def test_own_times_stay_whatever_the_rate(capsys: pytest.CaptureFixture[str]) -> None:
    assert times([0.0, 0.1, 1.3, 1.4], 25.0) == [0.0, 0.1, 1.3, 1.4]
    assert "--rate 25 is not used" in capsys.readouterr().err


def test_a_rate_counts_where_there_are_none() -> None:
    assert times([None, None, None], 4.0) == [0.0, 0.25, 0.5]
    assert times([None, None]) == [None, None]


def test_times_that_do_not_advance_are_mended_and_said_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert times([5.0, 5.0, 5.0, 6.0]) == pytest.approx([5.0, 5.1, 5.2, 6.0])
    assert times([0.0, 0.2, 0.1, 0.9]) == pytest.approx([0.0, 0.2, 0.4, 0.9])
    assert capsys.readouterr().err.count("is not after") == 2
