# SPDX-License-Identifier: Apache-2.0
"""The coverage flow: reading and merging, exclusions, bars, and a test bench whose records are complete."""

from __future__ import annotations

import subprocess
from collections import Counter
from pathlib import Path

import pytest

from cocotb_tests.env.covered import Stalls
from sim.coverage import exclusions, functional
from sim.coverage.page import page
from sim.coverage.points import Point, merged, read
from sim.coverage.record import COUNTERS, VARIABLE
from sim.coverage.verdict import judge
from sim.testbench.runner import simulate
from sim.toolchain import RTL, verilator_root

FIFO = RTL / "cells" / "slog_fifo.sv"


def _line(file: Path, line: int, kind: str, what: str, instance: str, count: int) -> str:
    fields = {"f": str(file), "l": str(line), "n": "3", "t": kind, "page": f"v_{kind}/{file.stem}__D4", "o": what,
              "h": instance}
    return "C '" + "".join(f"\x01{key}\x02{value}" for key, value in fields.items()) + f"' {count}\n"


@pytest.fixture
def records(tmp_path: Path) -> list[Path]:
    """Two records: of a FIFO in two instances and in another run, and of a bench that is no RTL."""
    first, second = tmp_path / "a.dat", tmp_path / "b.dat"
    first.write_text("# SystemC::Coverage-3\n" + _line(FIFO, 22, "toggle", "out_valid_o:0->1", "a", 0)
                     + _line(FIFO, 22, "toggle", "out_valid_o:0->1", "b", 2)
                     + _line(FIFO, 22, "toggle", "out_valid_o:1->0", "a", 0)
                     + _line(tmp_path / "tb_x.sv", 1, "line", "block", "t", 5)
                     + _line(RTL / "cells" / "slog_ram.sv", 22, "toggle", "mem_q[3][0]:0->1", "r", 0))
    second.write_text("# SystemC::Coverage-3\n" + _line(FIFO, 22, "toggle", "out_valid_o:0->1", "c", 3)
                      + _line(FIFO, 54, "branch", "else", "c", 0))
    return [first, second]


def test_points_of_all_instances_and_runs_are_one(records: list[Path]) -> None:
    hits = merged(records, RTL)
    assert {(p.kind, p.what): count for p, count in hits.items()} == {
        ("toggle", "out_valid_o:0->1"): 5, ("toggle", "out_valid_o:1->0"): 0, ("branch", "else"): 0}
    (branch,) = (p for p in hits if p.kind == "branch")
    assert branch.name == f"{FIFO.read_text().splitlines()[53].strip()} [else]"
    records[0].write_text("no record\n")
    with pytest.raises(ValueError, match="no coverage record"):
        read(records[0], RTL)


WIDE = """
#include <cstdio>
#include "verilated.h"
int main() {
  uint32_t counts[2 * 99] = {};
  VlWide<4> now{}, before{};
  now[0] = 1u << 3;
  VL_COV_TOGGLE_CHG_ST_W(99, counts, now, before);
  for (int k = 0; k < 2 * 99; ++k) if (counts[k]) std::printf("%d ", k);
}
"""


def test_toggles_of_wide_signals_are_counted_bit_by_bit(tmp_path: Path) -> None:
    """A change of bit 3 is counted for bit 3 alone; Verilator's own function counts it for bits 35 and 67 as well."""
    (tmp_path / "wide.cpp").write_text(WIDE)
    include = verilator_root() / "include"
    seen = []
    for header in (COUNTERS, include / "verilated_cov.h"):
        subprocess.run(["g++", "-std=gnu++20", "-w", f"-I{include}", f"-I{include / 'vltstd'}", "-include", header,
                        "-c", "wide.cpp"], cwd=tmp_path, check=True)
        subprocess.run(["g++", "wide.o", "-o", "wide", "-Wl,--unresolved-symbols=ignore-all"], cwd=tmp_path, check=True)
        seen.append(subprocess.run(["./wide"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout.split())
    assert seen[0] == ["7"]
    assert len(seen[1]) > 1, "Verilator counts right now: toggle.hpp can go"


def test_exclusions_are_reasoned_and_current(records: list[Path], tmp_path: Path) -> None:
    file = tmp_path / "exclusions.toml"
    hits = merged(records, RTL)

    def written(points: str, reason: str = "because it is tied to a constant", kind: str = "toggle") -> Path:
        file.write_text(f"[[exclude]]\nmodule = 'slog_fifo'\nkind = '{kind}'\npoints = '{points}'\n"
                        f"reason = '{reason}'\n")
        return file

    reasons = exclusions.apply(exclusions.load(written("out_valid_o:1->0")), hits)
    assert [p.what for p in reasons] == ["out_valid_o:1->0"]
    with pytest.raises(exclusions.ExclusionError, match="no toggle point is called 'out_valid'"):
        exclusions.apply(exclusions.load(written("out_valid")), hits)
    with pytest.raises(exclusions.ExclusionError, match="points"):
        exclusions.load(written("("))
    with pytest.raises(exclusions.ExclusionError, match="reason is missing"):
        exclusions.load(written("x", reason="no"))
    with pytest.raises(exclusions.ExclusionError, match="kind 'fsm'"):
        exclusions.load(written("x", kind="fsm"))


def test_bars_exclusions_that_are_hit_and_unmet_plans_are_faults() -> None:
    points = [Point(FIFO, 22, 3, "toggle", f"mem_q[{n}]:0->1") for n in range(100)]
    branch = Point(FIFO, 54, 5, "branch", "else")
    seen = functional.Functional(Counter({("g", "a"): 1}), Counter({"slog_fifo": 9}))
    hits = dict.fromkeys(points, 1) | {branch: 1}
    assert judge(hits, {}, seen, {("g", "a"): ""}).faults == []
    few = judge(hits | dict.fromkeys(points[:3], 0), {}, seen, {("g", "a"): ""})
    assert len(few.faults) == 1 and few.faults[0].startswith("toggle: 97.00 %")
    three = dict.fromkeys(points[:3], "r")
    assert judge(hits | dict.fromkeys(three, 0), three, seen, {("g", "a"): ""}).faults == []
    assert "branch: 0.00 %" in judge(hits | {branch: 0}, {}, seen, {("g", "a"): ""}).faults[0]
    assert "is excluded, but was hit" in judge(hits, {points[0]: "r"}, seen, {("g", "a"): ""}).faults[0]
    assert "4 of 101 points are excluded" in judge(
        hits | dict.fromkeys(points[:4], 0), dict.fromkeys(points[:4], "r"), seen, {("g", "a"): ""}).faults[0]
    assert "functional: 50.00 %" in judge(hits, {}, seen, {("g", "a"): "", ("g", "b"): ""}).faults[0]
    assert "not in the plan" in judge(hits, {}, seen, {("g", "b"): "cannot be"}).faults[0]
    assert "was met" in judge(hits, {}, seen, {("g", "a"): "cannot be"}).faults[0]
    assert "nothing was recorded" in judge({}, {}, functional.Functional(), {}).faults


def test_stalls_of_each_length_are_told_apart() -> None:
    stalls = Stalls(("in_valid_i", "in_ready_o", "out_valid_o", "data_o"))
    assert [pair[0] for pair in stalls.pairs] == ["in_valid_i"]
    for waits in (0, 0, 1, 5, 9):
        for _ in range(waits):
            stalls.observe({"in_valid_i": 1}, {"in_ready_o": 0})
        stalls.observe({"in_valid_i": 1}, {"in_ready_o": 1})
    for _ in range(3):  # withdrawn: these clocks are no wait of the next one
        stalls.observe({"in_valid_i": 1}, {"in_ready_o": 0})
    stalls.observe({"in_valid_i": 0}, {"in_ready_o": 1})
    stalls.observe({"in_valid_i": 1}, {"in_ready_o": 1})
    counts = {name.partition(": ")[2]: count for name, count in stalls.counts.items()}
    assert counts == dict(zip(functional.STALLS, (3, 1, 1, 1, 1, 1), strict=True))


@pytest.mark.slow
def test_a_bench_leaves_complete_records(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a queue with two places, every point is hit, and each output is compared on every clock."""
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    simulate("slog_fifo", "cocotb_tests.cells.test_fifo", {"Width": 1, "Depth": 2})
    hits = merged(tmp_path.rglob("*.dat"), RTL)
    assert {p.kind for p in hits} == {"line", "branch", "toggle"}
    assert all(hits.values()), [p.name for p, count in hits.items() if not count]
    seen = functional.collected(tmp_path.rglob("*.json"))
    assert seen.clocks == {"slog_fifo": 16 * 600}
    assert seen.undefined["slog_fifo", "out_valid_o"] == 0 < seen.undefined["slog_fifo", "out_data_o"]
    plan = dict.fromkeys(seen.counts, "")
    assert "slog_fifo.out_data_o" in page(hits, {}, seen, plan, judge(hits, {}, seen, plan))


def test_the_plan_and_the_exclusions_can_be_read() -> None:
    assert len(functional.plan()) > 100
    exclusions.load()
