# SPDX-License-Identifier: Apache-2.0
"""When routing counts as stuck, from the lines that nextpnr prints."""

from collections.abc import Sequence

import pytest

from sim.synth.tools import stuck


def _log(rounds: Sequence[tuple[int, int]]) -> str:
    lines = [f"Info:     iter={k} wires=994577 overused={shared} overuse={shared} tmgfail={late} archfail=NA"
             for k, (shared, late) in enumerate(rounds, 1)]
    return "\n".join(["Info: Running router2...", *lines, ""])


@pytest.mark.parametrize(("rounds", "expected"), [
    pytest.param([], False, id="no round yet"),
    pytest.param([(0, 40)] * 3, False, id="as many rounds as it may wait"),
    pytest.param([(0, 40)] * 4, True, id="the first stays the best"),
    pytest.param([(0, 171), (0, 160)] * 4, True, id="it swings between two states"),
    pytest.param([(0, 171), (0, 160), (0, 171), (0, 160), (0, 159)], False, id="a better one at last"),
    pytest.param([(90, 0), (50, 300), (20, 400), (4, 450), (0, 500)], False, id="shared wires go, late ends come"),
    pytest.param([(0, 2), (5, 0), (5, 0), (5, 0)], True, id="a shared wire is worse than late ends"),
])
def test_stuck_routing(rounds: list[tuple[int, int]], expected: bool) -> None:
    assert stuck(_log(rounds), patience=3) is expected
