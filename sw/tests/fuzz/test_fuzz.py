# SPDX-License-Identifier: Apache-2.0
"""A short campaign with a fixed seed: no command ends in a traceback, hangs, dies by a signal or is silently wrong."""

from __future__ import annotations

import resource
from pathlib import Path

import numpy as np
import pytest

from tests.fuzz.campaign import Campaign
from tests.fuzz.corpus import KINDS
from tests.fuzz.judge import FAILURES, Outcome, judge
from tests.fuzz.mutate import edits

CASES, SEED = 450, 16


@pytest.mark.slow
def test_damaged_inputs_are_read_or_refused_in_one_line(tmp_path: Path) -> None:
    campaign = Campaign(tmp_path / "fuzz", SEED)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    campaign.run(CASES)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"{campaign.summary()}\n{spent:.0f} s of the processors")
    assert not campaign.failures, campaign.summary()
    assert all(sum(campaign.outcomes[kind].values()) for kind in KINDS)
    refused, good = (sum(c[o] for c in campaign.outcomes.values()) for o in (Outcome.refused, Outcome.good))
    assert refused + good == CASES and min(refused, good) > CASES / 10


def test_the_judge_sees_every_failure(tmp_path: Path) -> None:
    good = {"t.csv": {"0": [["0", "1.5"]], "1": [["1", "2.5"]]}}
    table = tmp_path / "t.csv"
    table.write_text("frame,x_px\n0,1.5\n1,2.5\n")
    assert judge(0, "", tmp_path, good, True)[0] is Outcome.good
    assert judge(1, "signum: in/a.png: broken\n", tmp_path, good, True)[0] is Outcome.refused
    assert judge(1, "", tmp_path, good, True)[0] is Outcome.traceback, "status 1 without a line"
    assert judge(99, "Traceback\nValueError: x", tmp_path, good, True) == (Outcome.traceback, "ValueError: x")
    assert judge(-9, "", tmp_path, good, True)[0] is Outcome.hang
    assert judge(-11, "", tmp_path, good, True) == (Outcome.signal, "SIGSEGV")
    for text, said in (("0,1.5\n", ""), ("0,1.5\n1,inf\n", ""), ("0,1.4\n1,2.5\n", ""), ("0,1.5\n", "frame 0: lost")):
        table.write_text(f"frame,x_px\n{text}")
        assert judge(0, said, tmp_path, good, True)[0] is Outcome.wrong, text
    table.write_text("frame,x_px\n0,1.5\n")
    assert judge(0, "frames 1 to 1 are missing", tmp_path, good, True)[0] is Outcome.good, "it is said"
    table.unlink()
    assert judge(0, "", tmp_path, good, False)[0] in FAILURES


def test_damage_is_decided_by_its_seed() -> None:
    raw = bytes(range(256)) * 4
    drawn = [edits(raw, np.random.default_rng(s)) for s in (1, 1, 2)]
    assert drawn[0] == drawn[1] != drawn[2]
    ways = [edits(raw, np.random.default_rng(s)) for s in range(60)]
    assert any(e[0].stop == len(raw) and not e[0].new for e in ways), "cut"
    assert any(len(e[0].new) > 8 for e in ways), "spliced"
