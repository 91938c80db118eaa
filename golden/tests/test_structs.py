# SPDX-License-Identifier: Apache-2.0
"""Packed structs: the layouts are those of the RTL, and packing goes both ways."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from golden.correlate import Job, Result, Status
from golden.params import ROOT, SCORE_BITS
from golden.structs import (
    CONTEXT,
    JOB,
    LOAD,
    RESULT,
    STEP,
    STEP_ROW,
    TICKET,
    Layout,
    pack_job,
    pack_result,
    unpack_job,
)

SOURCES = [ROOT / "rtl" / "slog_pkg.sv", ROOT / "rtl" / "correlator" / "slog_fetch_pkg.sv"]
NAMES = {"job_t": JOB, "context_t": CONTEXT, "step_t": STEP, "result_t": RESULT, "load_t": LOAD, "ticket_t": TICKET,
         "row_t": STEP_ROW}
EXAMPLE = Job(5, 1, 2, 3, 4, 6, 7, 8, 9, 10, tag=11, surface=True)


def _rtl_fields(name: str) -> list[tuple[str, int]]:
    """Fields and bits of a struct as the packages declare it; an array is a field for each element, the last first."""
    text = "".join(path.read_text() for path in SOURCES)
    found = re.search(r"typedef struct packed \{([^}]*)\} " + name, text)
    assert found
    widths = {"status_e": 3, "job_t": JOB.bits}
    fields: list[tuple[str, int]] = []
    for kind, ranges, field in re.findall(r"^ *(\w+) *((?:\[[^\]]*\])*) *(\w+);", found[1], re.MULTILINE):
        tops = [SCORE_BITS - 1 if top == "ScoreW-1" else int(top) for top in re.findall(r"\[([\w-]+):0\]", ranges)]
        bits = widths.get(kind, tops[-1] + 1 if tops else 1)
        copies = range(tops[0], -1, -1) if len(tops) == 2 else [None]
        fields += [(field if k is None else f"{field}{k}", bits) for k in copies]
    return fields


@pytest.mark.parametrize("name", NAMES)
def test_layouts_are_those_of_the_rtl(name: str) -> None:
    assert list(NAMES[name].fields) == _rtl_fields(name)
    assert NAMES[name].bits == sum(bits for _, bits in _rtl_fields(name))


def test_pack_and_unpack() -> None:
    layout = Layout(("high", 3), ("low", 5))
    assert layout.pack({"high": 0b101, "low": 0b00110, "unused": 9}) == 0b10100110
    assert layout.unpack(0b10100110) == {"high": 0b101, "low": 0b00110}
    for name, value in (("high", 8), ("high", -1), ("low", 32)):
        with pytest.raises(ValueError, match=f"{name} = {value} does not fit"):
            layout.pack({"high": 0, "low": 0, name: value})
    assert layout.pack({"high": 7, "low": 31}) == 255
    with pytest.raises(KeyError):
        layout.pack({"high": 1})


def test_jobs_and_results() -> None:
    for job in (EXAMPLE, replace(EXAMPLE, surface=False)):
        assert unpack_job(pack_job(job)) == job
        assert JOB.unpack(pack_job(job))["search_x"] == 7
        assert isinstance(unpack_job(pack_job(job)).surface, bool)
    fields = RESULT.unpack(pack_result(Result(1, Status.OUTSIDE, 2, 3, 4, (10, 11, 12, 13, 14, 15, 16, 17), 5)))
    assert [fields[f"neighbour{k}"] for k in range(8)] == [10, 11, 12, 13, 14, 15, 16, 17]
    del fields["neighbour0"]
    assert {"tag": 1, "status": 4, "best_x": 2, "best_y": 3, "score": 4, "runner_up": 5}.items() <= fields.items()
