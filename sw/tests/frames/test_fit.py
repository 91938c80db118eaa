# SPDX-License-Identifier: Apache-2.0
"""How frames are scaled for the board."""

import numpy as np
import pytest

from golden.params import FULL
from signum.common.errors import SourceError
from signum.frames.fit import Fit


def test_fit_scales_down_never_up_and_back() -> None:
    small, large = Fit.to((320, 240), FULL, 64), Fit.to((1360, 1024), FULL, 64)
    assert not small.scaled and not small.note()
    assert large.board == (638, 480) and "638x480" in large.note()
    points = np.array([[0.0, 0.0], [679.5, 511.5], [1359.0, 1023.0]])
    assert np.allclose(large.to_source(large.to_board(points)), points)
    assert np.allclose(large.to_board(points[1]), [318.5, 239.5]), "centre on centre"
    assert large.show(np.zeros((1024, 1360, 3), np.uint8)).shape == (480, 638)
    assert large.coarser(160).board == (160, 120)


@pytest.mark.parametrize(("size", "says"), [((60, 50), "smaller than the 64x64 window.*--window 25"),
                                            ((400, 20), "is too small: the board takes 34x34 or more")])
def test_frame_smaller_than_the_window(size: tuple[int, int], says: str) -> None:
    with pytest.raises(SourceError, match=says):
        Fit.to(size, FULL, 64)
