# SPDX-License-Identifier: Apache-2.0
"""The flow of `make gates`: no test is left out, and nothing passes that did not run on a netlist."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.gates import flow
from sim.gates.flow import GateOutcome, chosen, command, main, outcome
from sim.gates.items import ELSEWHERE, ITEMS, GateItem
from sim.toolchain import ROOT

TESTS = ROOT / "cocotb_tests"


def test_every_cocotb_test_has_an_item() -> None:
    """Each file that simulates is in an item, or has a reason not to; a choice of its tests has a reason too."""
    simulating = {str(path.relative_to(TESTS)) for path in TESTS.rglob("test_*.py") if "simulate(" in path.read_text()}
    listed = {item.file for item in ITEMS if item.file}
    assert listed | set(ELSEWHERE) == simulating
    assert not listed & set(ELSEWHERE)
    assert len({item.name for item in ITEMS}) == len(ITEMS)
    for item in ITEMS:
        assert bool(item.tests) == bool(item.reason)
        for test in item.tests:
            assert f"def {test}(" in (TESTS / item.file).read_text()


def test_command() -> None:
    """An item runs the pytest functions it names, or the whole file, or the bench in Icarus."""
    assert command(GateItem("a", "a/test_a.py"))[-1] == "cocotb_tests/a/test_a.py"
    assert command(GateItem("a", "test_a.py", ("test_b", "test_c"), "why"))[-2:] == [
        "cocotb_tests/test_a.py::test_b", "cocotb_tests/test_a.py::test_c"]
    assert command(GateItem("a", "", netlist="icarus"))[1:] == ["-m", "sim.gates.icarus"]
    assert command(GateItem("a", "", netlist="routed"))[1:] == ["-m", "sim.gates.icarus", "--routed"]


def _log(tmp_path: Path, cells: int, tests: int) -> str:
    (tmp_path / "results.xml").write_text(f"<r><testsuite>{'<testcase/>' * tests}</testsuite></r>")
    return f"gates: {cells} cells, build/gates/a\nSIGNUM_SEED=1; log {tmp_path}/run.log\n.\n1 passed in 3 s\n"


def test_outcome(tmp_path: Path) -> None:
    """Cells and cocotb tests are counted; a failure, a skipped test, and a run without a netlist do not pass."""
    log = _log(tmp_path, 82, 3)
    assert outcome("a", log, 0, 1.0) == GateOutcome("a", True, 1, 82, 3, 1.0)
    assert not outcome("a", log, 1, 1.0).passed
    assert outcome("a", log + "1 skipped", 0, 1.0).reason == "a test was skipped"
    assert outcome("a", log.replace("gates:", "rtl:"), 0, 1.0).reason == "no netlist was simulated"
    assert outcome("a", _log(tmp_path, 82, 0), 0, 1.0).reason == "no netlist was simulated"


def test_choice() -> None:
    """Names choose items, in their order; an unknown one is refused in one line."""
    assert [item.name for item in chosen(["peak", "fifo"])] == ["peak", "fifo"]
    assert len(chosen([])) == len(ITEMS)
    with pytest.raises(SystemExit, match="no such item: nothing; there are fifo, "):
        chosen(["nothing"])


@pytest.mark.parametrize("passed", [True, False])
def test_exit_status(passed: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path,
                     capsys: pytest.CaptureFixture[str]) -> None:
    """The exit status is 1 if an item fails, which the table names."""
    monkeypatch.setattr(flow, "OUT", tmp_path)
    monkeypatch.setattr(flow, "run", lambda item: GateOutcome(item.name, passed, 1, 5, 2, 0.1, "" if passed else "why"))
    assert main(["fifo", "peak"]) == (0 if passed else 1)
    text = capsys.readouterr().out
    assert ("2 of 2 items passed, 4 tests" if passed else "failed: fifo, peak") in text
    assert (flow.OUT / "report.json").exists()
