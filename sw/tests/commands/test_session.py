# SPDX-License-Identifier: Apache-2.0
"""The session around every command, and options in groups."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from signum.commands import app
from signum.commands.options import BoardOptions
from signum.commands.session import Session
from signum.common.errors import SignumError


class Ended(BaseException):
    """Ends a run as neither an error of the user nor an interrupt does."""


@pytest.fixture
def film(tmp_path: Path) -> Path:
    """Three frames."""
    np.save(tmp_path / "film.npy", np.full((3, 100, 120), 90, np.uint8))
    return tmp_path / "film.npy"


def _run(film: Path, end: type[BaseException] | None, calls: list[str]) -> None:
    with Session("some", BoardOptions(window=32), film.parent / "out", str(film)) as run:
        run.report = lambda: calls.append("report")
        run.summary = lambda: f"{run.done} frames written"
        table = run.table("some.csv", ["frame"])
        run.at_end(lambda: calls.append("closed"))
        assert run.fit.source == (120, 100) and not calls
        run.measurer(run.fit.board).view(run.fit.show(run.first.picture))  # what the board's clocks are counted for
        for frame in run.steps("frames", run.frames(), run.source.count):
            if end is not None and frame.name == "2":
                raise end
            table.write([frame.name])
            run.tell("")


@pytest.mark.parametrize(("end", "done", "said"), [
    (None, 3, True), (KeyboardInterrupt, 2, True), (SignumError, 2, False), (Ended, 2, False)])
def test_however_it_ends_files_and_report_are_complete(
        film: Path, capsys: pytest.CaptureFixture[str], end: type[BaseException] | None, done: int, said: bool) -> None:
    calls: list[str] = []
    if end is None:
        _run(film, end, calls)
    else:
        with pytest.raises(end):
            _run(film, end, calls)
    assert calls == ["closed", "report"]
    assert (film.parent / "out" / "some.csv").read_text().split() == ["frame", "0", "1", "2"][:done + 1]
    printed = capsys.readouterr()
    assert (f"{done} frames written" in printed.out) == said == ("ms a frame at 150 MHz" in printed.err)


def test_a_folder_is_made_only_when_something_is_written(film: Path) -> None:
    with pytest.raises(SignumError, match="smaller than the 128x128 window"), Session(
            "some", BoardOptions(window=128), film.parent / "none", str(film)) as run:
        assert run.fit
    assert not (film.parent / "none").exists()


def test_a_group_of_options_is_one_object_with_its_own_defaults(monkeypatch: pytest.MonkeyPatch) -> None:
    alone = typer.Typer()
    monkeypatch.setattr(app, "app", alone)
    got: list[BoardOptions] = []
    defaults = BoardOptions(sigma=1.5)

    @app.command()
    def look(board: BoardOptions = defaults) -> None:
        got.append(board)
        if board.window == 100:
            raise SignumError("choose\nanother")

    assert CliRunner().invoke(alone, ["--window", "32"]).exit_code == 0
    assert got == [BoardOptions(sigma=1.5, window=32)]
    failed = CliRunner().invoke(alone, ["--window", "100"])
    assert failed.exit_code == 1 and failed.stderr == "signum: choose another\n"
