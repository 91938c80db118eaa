# SPDX-License-Identifier: Apache-2.0
"""The bars of `make hover` on shorter clips."""

from __future__ import annotations

import pytest

from signum.boards.golden import GoldenBoard
from tests.hover.bars import measure
from tests.hover.clips import Clip


@pytest.mark.parametrize("clip", [Clip("gravel", "pushed", 31, 50, blind=(18, 24)),
                                  Clip("world:brick", "occluded", 32, 36, blind=(20, 28)),
                                  Clip("brick", "pushed", 7, 60, blind=(24, 40))],
                         ids=lambda clip: clip.name)
def test_a_hover_holds_and_recovers(clip: Clip) -> None:
    with GoldenBoard() as board:
        found = measure(board, clip)
    assert found.due >= 18
    assert found.met, found.bars
    assert found.returns and len(found.lost_ms) >= clip.blind[1] - clip.blind[0]
