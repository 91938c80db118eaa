# SPDX-License-Identifier: Apache-2.0
"""A short sample of the soak with the run's seed; a planted fault is found, made short, kept and replayed."""

from __future__ import annotations

from pathlib import Path

import pytest

from signum.boards.golden import GoldenBoard
from signum.common.arrays import Image
from sim.seeds import session_seed
from tests.soak.__main__ import main
from tests.soak.campaign import PARTS, Campaign, draw, play
from tests.soak.case import Case
from tests.soak.shrink import shrink, words


@pytest.mark.parametrize("part", PARTS)
def test_a_case_of_each_part(part: str) -> None:
    case = draw(session_seed(), list(PARTS).index(part), config="tiny")
    met, difference = play(case)
    assert difference is None, "\n".join([str(difference), *words(case)])
    assert case.part == part and sum(met.values()) >= 10


def test_cases_are_decided_by_their_seed() -> None:
    assert draw(1, 0) == draw(1, 0) != draw(2, 0)


def test_a_case_is_made_as_short_as_it_gets() -> None:
    """What differs needs two operations of forty and one job of nine."""
    operations = tuple({"do": "submit", "number": n, "jobs": list(range(9))} for n in range(40))

    def differs(case: Case) -> bool:
        numbers = {o["number"] for o in case.operations}
        return {3, 31} <= numbers and any(o["number"] == 31 and 4 in o["jobs"] for o in case.operations)

    short = shrink(Case("boards", "tiny", 5, operations), differs)
    assert [o["number"] for o in short.operations] == [3, 31] and short.power_up == 0
    assert short.operations[1]["jobs"] == [4] and len(short.operations[0]["jobs"]) == 1


def test_a_planted_fault_is_kept_and_replayed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                              capsys: pytest.CaptureFixture[str]) -> None:
    """A golden board that spoils slot 2 is found; the kept case shows it by the printed command, and only then."""
    right = GoldenBoard._read_plane

    def wrong(board: GoldenBoard, slot: int) -> Image:
        plane = right(board, slot)
        plane[0, 0] ^= slot == 2
        return plane

    drawn = [{"do": "configure", "size": [20, 19], "sigma": 1.5}]
    drawn += [{"do": "capture", "slots": [slot], "camera": 0, "seeds": [5]} for slot in range(4)]
    drawn += [{"do": "plane", "slot": slot} for slot in range(4)]
    monkeypatch.setattr(GoldenBoard, "_read_plane", wrong)
    case, difference = Case("boards", "tiny", 9, tuple(drawn)), play(Case("boards", "tiny", 9, tuple(drawn)))[1]
    assert difference is not None and difference.kind == "plane"
    file = Campaign(1, tmp_path)._keep(case, difference)
    kept = Case.read(file)
    assert [o["do"] for o in kept.operations] == ["configure", "capture", "plane"] and kept.power_up == 0
    assert f"make soak REPLAY={file}" in capsys.readouterr().out
    assert main(["--replay", str(file)]) == 1
    monkeypatch.setattr(GoldenBoard, "_read_plane", right)
    assert main(["--replay", str(file)]) == 0


def test_bad_calls_end_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nothing = tmp_path / "nothing.json"
    assert main(["--replay", str(nothing)]) == 2
    nothing.write_text("{}")
    assert main(["--replay", str(nothing)]) == 2
    assert capsys.readouterr().err.count("\n") == 2
    with pytest.raises(SystemExit):
        main(["--parts", "lunch"])
