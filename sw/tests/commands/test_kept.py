# SPDX-License-Identifier: Apache-2.0
"""What is in an output folder stays, unless the same command made it and can make it again."""

import json
import os
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from signum.commands.cli import application
from signum.commands.outputs import Outputs, identity, lock, move_aside
from signum.common.errors import SignumError
from signum.common.files import write_picture

app = application()


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])


def _line(result: Result) -> str:
    assert result.exit_code == 1, result.output
    line, = (line for line in result.stderr.splitlines() if line.startswith("signum: "))
    return line


@pytest.fixture(scope="module")
def floor() -> np.ndarray:
    rng = np.random.default_rng(2)
    return np.asarray(cv2.GaussianBlur(rng.integers(0, 256, (700, 160), dtype=np.uint8), (0, 0), 1.5)) * 2


@pytest.fixture
def source(floor: np.ndarray, tmp_path: Path) -> Path:
    """Four overlapping pictures, straight down a floor."""
    folder = tmp_path / "in"
    folder.mkdir()
    for k in range(4):
        write_picture(folder / f"{k}.png", floor[40 * k:40 * k + 120])
    return folder


def _contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()
            and p.name != "report.html"}


def test_a_survey_is_never_wiped(source: Path, floor: np.ndarray, tmp_path: Path,
                                 monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "o"
    common = "--window", "32", "--out", out
    assert _run("mosaic", source, *common).exit_code == 0
    before = _contents(out)
    assert json.loads(before["run.json"])["finished"] and len(before["poses.csv"].splitlines()) == 5
    other = tmp_path / "other"
    other.mkdir()
    for k in range(2):
        write_picture(other / f"{k}.png", floor[300 + 40 * k:420 + 40 * k])
    assert f"holds a survey of {source}, not of {other}" in _line(_run("mosaic", other, *common))
    assert "made with --sigma 2.5 instead of 2.0" in _line(_run("mosaic", source, *common, "--sigma", "2"))
    assert "--anew moves it aside" in _line(_run("mosaic", source, *common, "--columns", "single"))
    assert _contents(out) == before
    # Another spelling of the same source, and the same call again: the same survey.
    monkeypatch.chdir(tmp_path)
    for spelling in ("in", tmp_path / "other" / ".." / "in", source):
        again = _run("mosaic", spelling, *common)
        assert again.exit_code == 0 and "finished" in again.stderr and _contents(out) == before
    # A frame that is new is added.
    write_picture(source / "4.png", floor[160:280])
    assert _run("mosaic", source, *common).exit_code == 0
    after = _contents(out)
    assert len(after["poses.csv"].splitlines()) == 6 and after["frames/000000.png"] == before["frames/000000.png"]
    # Started anew, the old one lies beside.
    assert _run("mosaic", other, *common, "--anew").exit_code == 0
    assert _contents(tmp_path / "o-1") == after and len((out / "poses.csv").read_text().splitlines()) == 3


def test_files_that_are_no_survey_stay(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "o"
    out.mkdir()
    (out / "mosaic.png").write_bytes(b"mine")
    (out / "notes.txt").write_text("mine")
    assert "holds mosaic.png, but no survey" in _line(_run("mosaic", source, "--window", "32", "--out", out))
    assert (out / "mosaic.png").read_bytes() == b"mine"
    inside = _line(_run("mosaic", source, "--window", "32", "--out", tmp_path, "--anew")) if (
        tmp_path / "mosaic.png").write_bytes(b"") == 0 else ""
    assert "cannot be moved aside" in inside and source.exists()


def test_a_frame_that_has_changed_is_named(source: Path, floor: np.ndarray, tmp_path: Path) -> None:
    out = tmp_path / "o"
    assert _run("mosaic", source, "--window", "32", "--out", out).exit_code == 0
    before = _contents(out)
    write_picture(source / "2.png", floor[301:421])
    assert "frame 2 is not the picture that it was" in _line(_run("mosaic", source, "--window", "32", "--out", out))
    assert _contents(out) == before


def test_quick_commands_replace_what_they_made_and_no_more(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "o"
    flow = "flow", source, "--window", "32", "--pictures", "1", "--out", out
    assert _run(*flow).exit_code == 0 and (out / "flow_1.png").exists()
    (out / "flow_mine.png").write_bytes(b"mine")
    (source / "3.png").unlink()
    assert _run(*flow).exit_code == 0
    assert (out / "flow_mine.png").read_bytes() == b"mine" and not (out / "flow_2.png").exists()
    (out / "track.csv").write_text("mine")
    assert "track.csv: is there already" in _line(_run("track", source, "--window", "32", "--out", out))
    assert (out / "track.csv").read_text() == "mine"


def test_what_a_live_source_gave_stays(tmp_path: Path) -> None:
    first = Outputs(tmp_path, "track", "camera 0", live=True)
    first.file("track.csv").write_text("seen once")
    first.close()
    for live in (True, False):
        with pytest.raises(SignumError, match=r"holds track\.csv of camera 0, which cannot be seen again"):
            Outputs(tmp_path, "track", "film.mp4", live)
    assert (tmp_path / "track.csv").read_text() == "seen once"


def test_a_record_names_only_files_of_its_folder(tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("mine")
    out = tmp_path / "o"
    out.mkdir()
    names = ["../precious", str(tmp_path / "precious"), 3, "a.csv"]
    (out / "run-track.jsonl").write_text('{"source": "x", "live": false}\n' + "\n".join(map(json.dumps, names)) + "\n{")
    (out / "a.csv").write_text("made")
    Outputs(out, "track").close()
    assert (tmp_path / "precious").exists() and not (out / "a.csv").exists()


def test_a_command_does_not_replace_what_it_reads(source: Path, tmp_path: Path,
                                                  monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "o"
    assert _run("flow", source, "--window", "32", "--out", out).exit_code == 0
    before = _contents(out)
    monkeypatch.chdir(out)
    for film in (out / "flow.mp4", "flow.mp4", "../o/flow.mp4"):
        assert "flow.mp4: signum flow has made it, and would replace it" in _line(
            _run("flow", film, "--window", "32", "--out", out))
    assert _contents(out) == before
    assert _run("mosaic", "flow.mp4", "--window", "32", "--out", ".").exit_code == 0, "another command's"
    assert _run("filter", source / "0.png", "--out", out).exit_code == 0
    assert "sign.png: signum filter has made it" in _line(_run("filter", "sign.png", "--out", out))


@pytest.mark.parametrize("command", ["mosaic", "track", "flow"])
def test_pictures_are_not_written_among_the_frames(command: str, source: Path, tmp_path: Path) -> None:
    """Else they would be frames of the next call: of another size, or removed before they are read."""
    before = _contents(source)
    (tmp_path / "link").symlink_to(source)
    for out in (source, tmp_path / "link", source / ".." / "in"):
        assert "is the folder of the frames" in _line(_run(command, source, "--window", "32", "--out", out))
    assert _contents(source) == before


def test_a_record_that_is_no_file_is_named(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "o"
    out.mkdir()
    os.mkfifo(out / "run-flow.jsonl")
    assert "run-flow.jsonl: not a file" in _line(_run("flow", source, "--window", "32", "--out", out))


def test_a_code_without_coordinates_is_refused(source: Path, tmp_path: Path) -> None:
    assert "--epsg is of the coordinates in a --navigation log" in _line(
        _run("mosaic", source, "--window", "32", "--out", tmp_path / "o", "--epsg", "32755"))


def test_an_empty_name_is_no_source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As of a variable of the shell that is not set: not the folder that one is in."""
    monkeypatch.chdir(tmp_path)
    write_picture(tmp_path / "0.png", np.zeros((120, 160), np.uint8))
    assert "name is empty" in _line(_run("track", "", "--window", "32", "--out", "o"))


@pytest.mark.parametrize("command", ["mosaic", "track", "report"])
def test_one_process_a_folder(command: str, source: Path, tmp_path: Path) -> None:
    out = tmp_path / "o"
    out.mkdir()
    held = lock(out)
    arguments = (command, out) if command == "report" else (command, source, "--window", "32", "--out", out)
    assert "another signum is writing into it" in _line(_run(*arguments))
    assert not list(out.iterdir())
    os.close(held)


def test_names_of_folders_moved_aside_and_of_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for _ in range(2):
        (tmp_path / "out").mkdir()
        move_aside(Path("out"))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out-1", "out-2"]
    (tmp_path / "a.bag").touch()
    assert identity("./a.bag#/cam") == f"{tmp_path / 'a.bag'}#/cam" and identity("camera:0") == identity("0") == "0"
    assert identity("world:frames=3") == "world:frames=3"
    (tmp_path / "dir #1").mkdir()
    (tmp_path / "dir #1" / "metadata.yaml").touch()
    assert identity("dir #1#/cam") == f"{tmp_path / 'dir #1'}#/cam" and identity("dir #1") == str(tmp_path / "dir #1")


def test_the_demonstration_leaves_a_survey_alone(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "o"
    assert _run("mosaic", source, "--window", "32", "--out", out).exit_code == 0
    before = _contents(out)
    assert "signum demo has not made it" in _line(_run("demo", "--board", "golden", "--out", out))
    assert {k: v for k, v in _contents(out).items() if k != "run-demo.jsonl"} == before


def test_pictures_in_the_folder_of_stored_frames_stay(source: Path, tmp_path: Path) -> None:
    """A diver's own `frames` beside the survey: as the source, and as pictures of something else."""
    dive = tmp_path / "dive"
    (source / "0.png").rename(source / "000001.png")
    dive.mkdir()
    source.rename(dive / "frames")
    before = _contents(dive)
    mosaic = "mosaic", "--window", "32", "--out", dive
    assert "dive/frames is the folder of the frames" in _line(_run(*mosaic, dive / "frames"))
    other = tmp_path / "other"
    other.mkdir()
    (other / "0.png").write_bytes((dive / "frames" / "1.png").read_bytes())
    assert "holds frames/000001.png, but no survey" in _line(_run(*mosaic, other))
    assert _contents(dive) == before


@pytest.mark.parametrize("name", ["mosaic.tif", "accuracy.csv", "poses-2.csv", "report.html", "frames/.part-mine"])
def test_files_named_as_those_of_a_survey_stay(name: str, source: Path, tmp_path: Path) -> None:
    mine = tmp_path / "o" / name
    mine.parent.mkdir(parents=True)
    mine.write_text("mine")
    result = _run("mosaic", source, "--window", "32", "--out", tmp_path / "o")
    assert mine.read_text() == "mine"
    assert result.exit_code == 0 if name.startswith("frames") else name in _line(result)


def test_a_continued_survey_replaces_no_other_file(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "o"
    common = "mosaic", source, "--window", "32", "--out", out
    assert _run(*common).exit_code == 0
    (out / "mosaic.tif").write_text("mine")
    assert "mosaic.tif: is there already, and this survey has not made it" in _line(
        _run(*common, "--range", "2", "--focal", "300"))
    assert (out / "mosaic.tif").read_text() == "mine"
    assert "poses.csv: is of the survey in" in _line(_run(*common, "--truth", out / "poses.csv"))


@pytest.mark.parametrize("command", ["track", "flow", "hold"])
def test_a_page_that_signum_has_not_made_stays(command: str, source: Path, tmp_path: Path) -> None:
    rest: tuple[str | Path, ...] = source, "--window", "32", "--out", tmp_path / "o"
    call = (command, *(["--source"] if command == "hold" else []), *rest)
    (tmp_path / "o").mkdir()
    (tmp_path / "o" / "report.html").write_text("mine")
    for _ in range(2):
        assert "report.html: is there already, and signum has not made it" in _line(_run(*call))
    assert (tmp_path / "o" / "report.html").read_text() == "mine"
    (tmp_path / "o" / "report.html").unlink()
    for other in (call, call, ("mosaic", *rest)):
        result = _run(*other)
        assert result.exit_code == 0 or "nothing could be measured" in result.stderr, result.output
        assert (tmp_path / "o" / "report.html").exists(), "pages of commands that share a folder"


def test_the_page_of_a_live_source_stays(source: Path, tmp_path: Path) -> None:
    first = Outputs(tmp_path / "o", "hold", "camera 0", live=True)
    first.file("report.html").write_text("seen once")
    first.close()
    for command, says in (("track", "is of camera 0, which cannot be seen again"), ("mosaic", "holds report.html")):
        assert says in _line(_run(command, source, "--window", "32", "--out", tmp_path / "o"))
    assert (tmp_path / "o" / "report.html").read_text() == "seen once"


def test_a_survey_behind_a_link_is_moved_aside_and_not_from_inside(source: Path, tmp_path: Path,
                                                                   monkeypatch: pytest.MonkeyPatch) -> None:
    out, link = tmp_path / "o", tmp_path / "link"
    link.symlink_to(out)
    out.mkdir()
    assert _run("mosaic", source, "--window", "32", "--out", out).exit_code == 0
    before = _contents(out)
    monkeypatch.chdir(out)
    assert "cannot be moved aside from inside it" in _line(
        _run("mosaic", source, "--window", "32", "--out", ".", "--anew"))
    monkeypatch.chdir(tmp_path)
    assert _contents(out) == before
    assert _run("mosaic", source, "--window", "32", "--out", link, "--anew").exit_code == 0
    assert _contents(tmp_path / "o-1") == before == _contents(out)


def test_a_simulated_survey_does_not_replace_an_interrupted_one(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "o"
    assert _run("mosaic", source, "--window", "32", "--out", out).exit_code == 0
    for name in ("mosaic.png", "poses.csv"):  # as after a kill
        (out / name).unlink()
    before = _contents(out)
    simulated = "navigate", out, "--simulate", "pan-tilt", "--out", tmp_path / "n"
    assert "of a survey that was not simulated" in _line(_run(*simulated))
    (out / "simulated.txt").write_text("pan-tilt, seed 0")
    assert "of a survey that was not simulated" in _line(_run(*simulated))
    (out / "simulated.txt").unlink()
    assert _contents(out) == before


def test_a_link_that_leads_nowhere_is_said(source: Path, tmp_path: Path) -> None:
    (tmp_path / "o").symlink_to("nothing")
    assert "o is a link that leads nowhere" in _line(_run("track", source, "--out", tmp_path / "o"))


def test_a_command_called_again_leaves_the_page_until_it_writes_it(tmp_path: Path) -> None:
    """It tells of the runs of other commands too."""
    for _ in range(2):
        outputs = Outputs(tmp_path, "track")
        outputs.file("report.html").write_text("track and flow")
        outputs.close()
        Outputs(tmp_path, "track").close()
        assert (tmp_path / "report.html").exists()


@pytest.mark.parametrize("name", ["run.json", "poses.csv"])
def test_a_loop_of_links_in_place_of_a_surveys_file(name: str, source: Path, tmp_path: Path) -> None:
    out = tmp_path / "o"
    assert _run("mosaic", source, "--window", "32", "--out", out).exit_code == 0
    (out / name).unlink()
    (out / name).symlink_to(out / name)
    result = _run("mosaic", source, "--window", "32", "--out", out, "--resume")
    assert result.exception is None or isinstance(result.exception, SystemExit), result.output
