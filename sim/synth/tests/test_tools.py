# SPDX-License-Identifier: Apache-2.0
"""When routing counts as stuck, from the lines that nextpnr prints, and what becomes of a tool that is or fails."""

import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from sim.synth import tools
from sim.synth.tools import run_tool, stuck


def _log(left: Sequence[int]) -> str:
    lines = [f"Info: {1000 * k:10} | {100 * k:8} {900 * k:10} | {100:4} {900:5} | {wires:9}|      0.65     {k}.00|"
             for k, wires in enumerate(left, 1)]
    return "\n".join(["Info: Routing..", "Info:    IterCnt |  w/ripup   wo/ripup |  w/r  wo/r |      arcs|", *lines,
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


@pytest.fixture
def tool(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A tool's script, to be written, beside nine reports with the same open wires."""
    script = tmp_path / "tool.py"
    monkeypatch.setattr(tools, "installed_tool", lambda *_: sys.executable)
    (tmp_path / "reports.txt").write_text(_log([40] * 9))
    return script


def _run(script: Path, end: str, patience: int | None = 3) -> bool:
    reports = str(script.with_name("reports.txt"))
    script.write_text(f"import sys, time\nprint(open({reports!r}).read(), flush=True)\n{end}\n")
    return run_tool("router", script.with_name("log"), str(script), patience=patience)


def test_a_stuck_tool_is_stopped(tool: Path) -> None:
    began = time.monotonic()
    assert not _run(tool, "time.sleep(60)")
    assert time.monotonic() - began < 30


@pytest.mark.parametrize("seconds", [0.0, 0.5])
def test_a_tool_that_ends_is_not_stuck(tool: Path, seconds: float) -> None:
    """Its last reports may be the same, and it may end between two looks at them."""
    assert _run(tool, f"time.sleep({seconds})")


def test_a_tool_that_fails_is_named_with_the_end_of_its_log(tool: Path) -> None:
    """Unless another one may try."""
    end = "time.sleep(0.5); print('out of room', flush=True); sys.exit(3)"
    assert not _run(tool, end)
    with pytest.raises(SystemExit, match=r"(?s)router failed with status 3; .*log ends:\n.*out of room"):
        _run(tool, end, patience=None)
