# SPDX-License-Identifier: Apache-2.0
"""The mutation flow itself: what it changes, that it changes nothing at mutant 0, and what it refuses."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

from sim.mutate import flow, plan, reasons, run
from sim.mutate.calls import Call
from sim.mutate.sites import Mutant, mutants_of
from sim.mutate.source import mutated, only
from sim.toolchain import rtl_sources, wide_sources

TINY = """\
module slog_tiny #(
    parameter int unsigned Width = 3 + 1
) (
    input  logic             clk_i,
    input  logic             rst_i,
    input  logic [Width-1:0] in_i,
    output logic             out_o
);
  logic [Width-1:0] in_q, sum_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) in_q <= '0;
    else in_q <= in_i;
    sum_q <= in_q + in_i[2:1];
    for (int unsigned n = 0; n < 2; n++) if (in_i[n]) sum_q <= '1;
  end
  assign out_o = sum_q[3] && in_q != 4'd5;
`ifndef SYNTHESIS
  int unsigned counted;
  always_ff @(posedge clk_i) counted <= counted + 1;
`endif
  `SLOG_ASSERT(SlogTiny, in_q == in_q && 1'b1)
endmodule : slog_tiny
"""


@pytest.fixture(name="tiny")
def _tiny(tmp_path: Path) -> Path:
    path = tmp_path / "slog_tiny.sv"
    path.write_text(TINY)
    return path


def _found(path: Path) -> set[tuple[int, str, str]]:
    return {(m.line, m.operator, m.changed) for m in mutants_of(path)}


def test_sites(tiny: Path) -> None:
    found = _found(tiny)
    assert {(11, "reset value dropped", ""), (11, "condition negated", "!(rst_i)"), (11, "constant", "'1"),
            (12, "assignment dropped", ""), (12, "in_i to in_q", "in_q"), (13, "+ to -", "in_q - in_i[2:1]"),
            (13, "operand of + dropped", "in_q"), (14, "condition negated", "!(in_i[n])"),
            (16, "&& to ||", "sum_q[3] || in_q != 4'd5"), (16, "operand of && dropped", "sum_q[3]"),
            (16, "!= to ==", "in_q == 4'd5"), (16, "constant", "4'd6"), (16, "constant", "4'd4"),
            (16, "constant", "2")} <= found
    assert any(operator == "top bit of a sum dropped" for _, operator, _ in found)
    assert {operator for line, operator, _ in found if line == 13} >= {"top bit of a slice dropped",
                                                                       "slice shifted by one"}


def test_what_is_no_circuit_stays(tiny: Path) -> None:
    """Parameters, declarations, bounds of loops and slices, code for assertions only, and assertions."""
    lines = {line for line, _, _ in _found(tiny)}
    assert lines == {11, 12, 13, 14, 16}
    assert not [m for m in mutants_of(tiny) if m.line == 14 and m.original in ("0", "2", "n < 2", "n")]
    assert not [m for m in mutants_of(tiny) if m.line == 13 and m.original in ("1", "2")]


def test_names_outlive_other_changes(tiny: Path) -> None:
    before = {(m.name, m.original, m.changed) for m in mutants_of(tiny)}
    assert len({name for name, _, _ in before}) == len(before)
    tiny.write_text("// A line more.\n" + TINY.replace("in_q <= in_i;", "in_q <= ~in_i;"))
    after = {(m.name, m.original, m.changed) for m in mutants_of(tiny)}
    assert len(before - after) <= 3 and "~ changed" in {m.operator for m in mutants_of(tiny)}


def test_all_mutants_in_one_source(tiny: Path) -> None:
    mutants = mutants_of(tiny)
    text = mutated(TINY.encode(), mutants)
    assert text.count("\n") == TINY.count("\n")
    for number, mutant in enumerate(mutants, 1):
        assert text.count(f"slog_mutant_pkg::id {'!=' if mutant.statement else '=='} {number} ") \
            + text.count(f"slog_mutant_pkg::id != {number})") == 1
    # Without the choices, the text is the original's.
    assert mutated(TINY.encode(), []) == TINY


def test_one_mutant_alone(tiny: Path) -> None:
    swap = next(m for m in mutants_of(tiny) if m.operator == "&& to ||")
    assert only(TINY.encode(), swap).splitlines()[15] == "  assign out_o = (sum_q[3] || in_q != 4'd5);"
    dropped = next(m for m in mutants_of(tiny) if m.operator == "assignment dropped" and m.line == 12)
    assert only(TINY.encode(), dropped).splitlines()[11] == "    else ;"


def test_every_module_has_mutants_or_a_reason() -> None:
    names = {path.stem for config in ("tiny", "tiny_dense") for path in rtl_sources(config)}
    names |= {path.stem for path in wide_sources()}
    assert names - set(plan.TESTS) - set(plan.WITHOUT) == set()
    for file in {file for files in plan.TESTS.values() for file in files}:
        assert Path(*file.split(".")).with_suffix(".py").exists()


def test_named_mutants_are_listed() -> None:
    for module, operator, part in plan.NAMED:
        assert [m for m in plan.listed(module) if m.operator.startswith(operator) and part in m.original]


def test_sample_repeats_with_its_seed() -> None:
    drawn = [plan.sample(["slog_fifo", "slog_stage", "slog_grid"], 14, random.Random(seed)) for seed in (1, 1, 2)]
    assert drawn[0] == drawn[1] != drawn[2]
    assert sorted(map(len, drawn[0].values())) == [2, plan.EACH, plan.EACH]


def _outcome(mutant: Mutant, killed: bool) -> run.Fate:
    return run.Fate(mutant.name, "test", killed, "test" if killed else "", "", 0.1)


def test_survivors_need_a_reason(tiny: Path) -> None:
    first, second, third = mutants_of(tiny)[:3]
    outcomes = {m.name: _outcome(m, killed) for m, killed in ((first, True), (second, False), (third, False))}
    why = {third.name: reasons.Explanation(third.name, "argument", "a reason")}
    [fault] = flow.judge({"slog_tiny": [first, second, third]}, outcomes, why)
    assert fault.startswith("survives without a reason") and second.name in fault
    [fault] = flow.judge({"slog_tiny": [first]}, outcomes, {first.name: why[third.name]})
    assert "was killed" in fault


@pytest.mark.parametrize("entry", [
    'why = "It changes a register that nothing reads."', 'kind = "proof"\nwhy = "equal"',
    'kind = "argument"\nwhy = "It was not observed to change any output of the module."'])
def test_reasons_are_reasons(entry: str, tmp_path: Path) -> None:
    path = tmp_path / "reasons.toml"
    path.write_text(f'["tiny-01234567"]\n{entry}\n')
    with pytest.raises(SystemExit, match="tiny-01234567 needs"):
        reasons.load(path)


def test_reason_for_no_mutant(tiny: Path) -> None:
    names = [m.name for m in mutants_of(tiny)]
    assert reasons.unknown(["tiny-01234567", names[0]], names) == ["tiny-01234567"]
    assert reasons.unknown(reasons.load(), [m.name for module in plan.TESTS for m in plan.possible(module)]) == []


def test_broken_fifo_is_found_and_mutant_0_is_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One build of the smallest queue: its tests pass at mutant 0, on which `run_module` insists, and kill another."""
    monkeypatch.setattr(run, "FOLDER", tmp_path)  # nothing is known yet
    call = Call("slog_fifo", "cocotb_tests.cells.test_fifo", {"Width": 1, "Depth": 1})
    outcomes = run.run_module("slog_fifo", plan.listed("slog_fifo")[:1], [call], print)
    [outcome] = outcomes.values()
    assert outcome.killed and re.search(r"clock \d+: \w+: RTL 0x\w+, model 0x\w+", outcome.why)
