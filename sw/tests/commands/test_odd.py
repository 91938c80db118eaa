# SPDX-License-Identifier: Apache-2.0
"""Odd things among pictures, in names and in numbers: refused in a line, or read as they are."""

from __future__ import annotations

import os
import signal
import warnings
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from signum.commands.cli import application
from signum.common.files import write_picture
from signum.frames.eight import EightBits
from signum.report.about import MARK, head
from signum.report.movie import Movie
from tests.fuzz.corpus import frames

APP = application()


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(APP, [str(a) for a in arguments])


@pytest.mark.parametrize("command", ["track", "mosaic"])
def test_a_pipe_among_the_pictures_is_refused_at_once(command: str, tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    os.mkfifo(folder / "0.png")
    signal.alarm(60)  # else a test that waits for the pipe would never end
    result = _run(command, folder, "--out", tmp_path / "o")
    signal.alarm(0)
    assert result.exit_code == 1 and "0.png: a pipe; expected a picture" in result.stderr


@pytest.mark.parametrize("name", ["\u6d77" * 80, "a\x1b[31mb"], ids=["long", "control"])
def test_long_and_odd_names_of_frames_make_files(name: str, tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    for k, picture in enumerate(frames()[:3]):
        write_picture(folder / f"{name}{k}.png", picture)
    result = _run("flow", folder, "--window", "32", "--pictures", "1", "--out", tmp_path / "o")
    made = [file.name for file in (tmp_path / "o").glob("flow_*.png")]
    assert result.exit_code == 0 and len(made) == 2 and all(text.isprintable() for text in made), result.output
    result = _run("stereo", folder, folder, "--window", "16", "--out", tmp_path / "s")
    assert len(list((tmp_path / "s").glob("range_*.tiff"))) == 3, result.output


def test_a_film_in_a_folder_with_a_colon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    film = Movie(Path("a:b.mp4"))
    for picture in frames()[:3]:
        film.write(picture)
    film.close()
    assert Path("a:b.mp4").stat().st_size > 100


@pytest.mark.parametrize("factor", [1e-42, 1e-310, 1e36, 1e300])
def test_pictures_of_very_small_and_large_numbers(factor: float) -> None:
    ramp = np.arange(200, dtype=np.float64).reshape(10, 20) * factor
    kinds = [np.float64] if factor in (1e300, 1e-310) else [np.float32, np.float64]
    for kind in kinds:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            shown = EightBits("x")(ramp.astype(kind))
        assert shown.max() == 0 if factor < 1e-30 else shown.max() > 90


@pytest.mark.parametrize("runs", [None, "[" * 100_000, '[{"command": "a", "version": "1", "frames": 1e999}]'])
def test_a_page_that_is_no_page(runs: str | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "report.html"
    if runs is None:
        os.mkfifo(page)
    else:
        page.write_text(f"{MARK}{runs}</script>")
    signal.alarm(60)
    assert head(page) == "" and "cannot be read" in capsys.readouterr().err
    signal.alarm(0)
