# SPDX-License-Identifier: Apache-2.0
"""The page: a short version of each section, and the outcome when a section fails or misses its bar."""

import csv
from pathlib import Path

import pytest

from signum.boards.golden import GoldenBoard
from signum.common.console import progress
from signum.report.page import Bar, Section
from signum.reproduce import Maker, OpenBoard, Progress
from signum.reproduce import __main__ as command
from signum.reproduce.makers import MAKERS


@pytest.mark.parametrize("name", list(MAKERS))
def test_short_version(name: str, tmp_path: Path) -> None:
    sections = MAKERS[name](GoldenBoard, tmp_path, 0, True, progress)
    assert sections and all(section.title and section.html for section in sections)
    bars = [bar for section in sections for bar in section.bars]
    print("\n".join(str(bar) for bar in bars))
    assert bars and all(bar.met for bar in bars)


def _maker(measured: float) -> Maker:
    def make(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
        assert open_board().name == "golden" and seed == 3 and quick and out.is_dir()
        return [Section("a figure", "<p>shown</p>", (Bar("error, px", measured, "<=", 1.0),))]
    return make


def _broken(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
    raise RuntimeError("no such luck")


@pytest.mark.parametrize(("parts", "status", "says"), [
    ({"good": _maker(0.5)}, 0, "1 of 1 bars met"), ({"bad": _maker(2.0), "good": _maker(0.5)}, 1, "1 of 2 bars met"),
    ({"broken": _broken, "good": _maker(0.5)}, 1, "failed: broken"), ({"nothing": _maker(float("nan"))}, 1, "MISSED")])
def test_status_page_and_bars(parts: dict[str, Maker], status: int, says: str, tmp_path: Path,
                              monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(command, "MAKERS", parts)
    assert command.main(["--out", str(tmp_path / "page"), "--seed", "3", "--quick"]) == status
    assert says in capsys.readouterr().out
    page = (tmp_path / "page" / "index.html").read_text()
    assert "shown" in page and "seed 3" in page and ("no such luck" in page) == ("broken" in parts)
    with (tmp_path / "page" / "bars.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(parts) - ("broken" in parts)
    assert all((r["met"] == "1") == (float(r["measured"]) <= 1.0) for r in rows)


def test_stopped_keeps_what_was_finished(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "MAKERS", {"good": _maker(0.5), "stop": stop})
    assert command.main(["--out", str(tmp_path), "--seed", "3", "--quick"]) == 130
    assert "shown" in (tmp_path / "index.html").read_text()
