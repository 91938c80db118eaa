# SPDX-License-Identifier: Apache-2.0
"""When routing counts as stuck, from the lines that nextpnr prints."""

from collections.abc import Sequence

import pytest

from sim.synth.tools import stuck


def _log(left: Sequence[int]) -> str:
    lines = [f"Info: {1000 * k:10} | {100 * k:8} {900 * k:10} | {100:4} {900:5} | {wires:9}|      0.65     {k}.00|"
             for k, wires in enumerate(left, 1)]
    return "\n".join(["Info: Routing..", "Info:    IterCnt |  w/ripup   wo/ripup |  w/r  wo/r |      pend|", *lines,
                      "Info: [  5242,   5497) |****", ""])


@pytest.mark.parametrize(("left", "expected"), [
    pytest.param([], False, id="no report yet"),
    pytest.param([90, 80, 70, 60, 50, 40], False, id="wires are routed"),
    pytest.param([40] * 3, False, id="as many reports as it may wait"),
    pytest.param([40] * 4, True, id="the first stays the best"),
    pytest.param([20, 16, 30, 17, 16], True, id="it swings"),
    pytest.param([20, 16, 30, 17, 15], False, id="a better one at last"),
])
def test_stuck_routing(left: Sequence[int], expected: bool) -> None:
    assert stuck(_log(left), patience=3) is expected
