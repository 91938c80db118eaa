# SPDX-License-Identifier: Apache-2.0
"""What is refused at the border, in one line that names the file, the field and what is expected; and what is
unexpected, which leaves a log."""

from __future__ import annotations

import csv
import errno
import os
import signal
import struct
import zlib
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from signum.applications.mosaic.track_reader import read_track
from signum.applications.navigate.chart import Chart
from signum.commands import app as commands
from signum.commands import filter as filter_command
from signum.commands.cli import application
from signum.common.errors import SignumError
from signum.common.files import write_picture
from signum.geometry.calibration import CalibrationError, read_mono, read_stereo
from signum.report import folder as folder_report
from signum.report.read_table import read_table
from signum.sources.open import open_source
from signum.tables.table import Table
from tests.fuzz.corpus import SIZE, build, calibration, frames

APP = application()


@pytest.fixture(autouse=True)
def no_hang() -> Iterator[None]:
    """A test that waits for a pipe ends by the alarm."""
    signal.alarm(120)
    yield
    signal.alarm(0)


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("borders") / "inputs"
    build(folder)
    return folder


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(APP, [str(a) for a in arguments])


def _line(result: Result) -> str:
    assert result.exit_code == 1, result.output
    lines = [line for line in result.stderr.splitlines() if line.startswith("signum: ")]
    assert len(lines) == 1, result.stderr
    return lines[0]


MATRIX = np.array([[160.0, 0, 79.5], [0, 160.0, 59.5], [0, 0, 1]])
BAD_CAMERAS: dict[str, tuple[str, dict[str, Any]]] = {
    "nan": ("camera_matrix", {"camera_matrix": MATRIX * np.nan}),
    "inf": ("camera_matrix", {"camera_matrix": np.where(MATRIX == 160, np.inf, MATRIX)}),
    "huge": ("camera_matrix", {"camera_matrix": np.where(MATRIX == 160, 1e308, MATRIX)}),
    "zero focal": ("camera_matrix: focal length x", {"camera_matrix": np.diag([0, 160.0, 1])}),
    "negative focal": ("camera_matrix: focal length y", {"camera_matrix": np.diag([160.0, -160, 1])}),
    "shape": ("camera_matrix has shape 1x3", {"camera_matrix": MATRIX[:1]}),
    "last row": ("camera_matrix: expected fx s cx", {"camera_matrix": np.ones((3, 3)) * 160}),
    "missing": ("has no camera_matrix or K", {"camera_matrix": None}),
    "integers": ("camera_matrix has dt 'i'", {"camera_matrix": MATRIX.astype(np.int32)}),
    "text": ("camera_matrix is no matrix", {"camera_matrix": "160"}),
    "coefficients": ("distortion_coefficients has shape 1x3", {"distortion_coefficients": np.zeros((1, 3))}),
    "coefficient": ("distortion_coefficients contains", {"distortion_coefficients": np.full((1, 5), 1e308)}),
    "size 0": ("image_width is 0", {"image_width": 0}), "negative size": ("image_width is -160", {"image_width": -160}),
    "half a pixel": ("image_height is no whole number", {"image_height": 120.5}),
    "no size": ("has no image_width", {"image_width": None}),
    "large": ("image_width and image_height: 60000x60000 are 3600 megapixels",
              {"image_width": 60000, "image_height": 60000}),
}
BAD_PAIRS: dict[str, tuple[str, dict[str, Any]]] = {
    "R 0": ("R is no rotation", {"R": np.zeros((3, 3))}), "R scaled": ("R", {"R": 2 * np.eye(3)}),
    "R mirrored": ("R is no rotation", {"R": np.diag([1.0, 1, -1])}),
    "R nan": ("R contains nan", {"R": np.eye(3) * np.nan}),
    "T 0": ("T is of length 0", {"T": np.zeros((3, 1))}),
    "T in no unit": ("T is of length 15; expected metres", {"T": np.array([[-15.0], [0], [0]])}),
    "T huge": ("T contains", {"T": np.full((3, 1), 1e308)}),
    "T shape": ("T has shape 2x1", {"T": np.zeros((2, 1))}), "K2": ("K2", {"K2": MATRIX * 0}),
    "D1": ("D1", {"D1": np.full((1, 5), np.inf)}), "above": ("above or below", {"T": np.array([[0.0], [0.1], [0]])}),
    "behind": ("before or behind", {"T": np.array([[0.0], [0.0], [0.1]])}),
}


@pytest.mark.parametrize("name", BAD_CAMERAS)
def test_a_camera_is_checked_field_by_field(tmp_path: Path, name: str) -> None:
    says, changed = BAD_CAMERAS[name]
    path = calibration(tmp_path / "c.yaml", **changed)
    with pytest.raises(CalibrationError) as error:
        read_mono(path)
    assert str(error.value).startswith(f"{path}: ") and says in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("name", BAD_PAIRS)
def test_a_stereo_pair_is_checked_field_by_field(tmp_path: Path, name: str) -> None:
    says, changed = BAD_PAIRS[name]
    path = calibration(tmp_path / "c.yaml", **changed)
    with pytest.raises(CalibrationError) as error:
        read_stereo(path)
    assert str(error.value).startswith(f"{path}: ") and says in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(("text", "says"), [
    ("rows: 1000000000", "expected a number from 1 to 65535"), ("rows: 9", "has 9 numbers; expected 27"),
    ("rows: -3", "expected a number from 1"), ("dt: u", "has dt 'u'"), ("dt: 3d", "not an OpenCV YAML"),
    ("data: 1", "numbers")])
def test_a_matrix_is_what_its_head_says(tmp_path: Path, text: str, says: str) -> None:
    path = calibration(tmp_path / "c.yaml")
    field = text.split(":")[0]
    head, _, tail = path.read_text().partition("camera_matrix:")
    lines = tail.splitlines()
    index = next(i for i, line in enumerate(lines) if line.strip().startswith(f"{field}:"))
    stop = index + 1
    while field == "data" and "]" not in lines[stop - 1]:
        stop += 1
    lines[index:stop] = [f"   {text}"]
    path.write_text(f"{head}camera_matrix:" + "\n".join(lines) + "\n")
    with pytest.raises(CalibrationError, match=says):
        read_mono(path)


@pytest.mark.parametrize("data", [b"", b"\0\1\2", b"\xff\xfe", b"no yaml",
                                  b"%YAML:1.0\n---\na: " + b"[" * 9000, b"a: [1"])
def test_no_calibration_at_all(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "c.yaml"
    path.write_bytes(data)
    with pytest.raises(CalibrationError) as error:
        read_mono(path)
    assert str(path) in str(error.value)


@pytest.mark.parametrize(("rows", "says"), [
    ("1,1e308,0.2", "frame 1: east_m is 1e.308; expected"), ("1,0,1,0.2", "row 2 .* has 4 cells, the head has 3"),
    ("1,0", "row 2 .* has 2 cells"), ("1,0.1,x", "north_m is 'x'; expected"),
    ("0,1,2", "frame 0 is listed twice"),
    ("1,0.1,0.2\0", "byte 40 is zero")])
def test_a_navigation_log_is_checked_cell_by_cell(tmp_path: Path, rows: str, says: str) -> None:
    path = tmp_path / "n.csv"
    path.write_text(f"frame,east_m,north_m\n0,0.0,0.0\n{rows}\n2,0.2,0.4\n")
    with pytest.raises(SignumError, match=says) as error:
        read_track(path)
    assert str(error.value).startswith(f"{path}: ")


def test_named_places_are_checked(tmp_path: Path) -> None:
    write_picture(tmp_path / "mosaic.png", frames()[0])
    for text, says in (("name,x_px\nrock,1\n", "expected name, x_px, y_px"),
                       ("name,x_px,y_px\nrock,inf,1\n", "rock: x_px"),
                       ("name,x_px,y_px\nrock,1,x\n", "rock: y_px is 'x'")):
        (tmp_path / "places.csv").write_text(text)
        with pytest.raises(SignumError, match=says):
            Chart.load(tmp_path)
    (tmp_path / "places.csv").unlink()
    with pytest.raises(SignumError, match="expected a number"):
        Chart.load(tmp_path).place("nan,1")


@pytest.mark.parametrize(("shape", "says"), [
    ("(-1, 120, 160)", r"shape \(-1, 120, 160\); expected"), ("(5, 120, 0)", r"shape \(5, 120, 0\); expected"),
    ("(9, 120, 160)", "expected 172800"), ("(3, 120, 160)", "expected 57600"), ("(1,) * 10**9", "not a NumPy"),
    ("(4, 120000, 160000)", "megapixels"), ("(" * 3000, "not a NumPy")])
def test_an_array_is_what_its_head_says(tmp_path: Path, shape: str, says: str) -> None:
    head = f"{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}, }}".encode()
    path = tmp_path / "x.npy"
    path.write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + bytes(4 * 120 * 160))
    with pytest.raises(SignumError, match=says) as error:
        list(open_source(path))
    assert str(path) in str(error.value)


def _declared(path: Path, width: int, height: int) -> Path:
    """A PNG whose head gives a size that its data have not."""
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(bytes(100))) + chunk(b"IEND", b""))
    return path


@pytest.mark.parametrize("side", [2**31 - 1, 60000])
def test_a_large_picture_is_refused_by_its_head(tmp_path: Path, side: int) -> None:
    path = _declared(tmp_path / "a.png", side, side)
    line = _line(_run("filter", path, "--out", tmp_path / "o"))
    assert str(path) in line and "the limit is 200" in line and "--megapixels" in line


def test_an_option_lifts_and_lowers_the_limit_of_pixels(tmp_path: Path, inputs: Path) -> None:
    path = inputs / "png" / "a.png"
    assert "the limit is 0.01" in _line(_run("filter", path, "--megapixels", "0.01", "--out", tmp_path / "o"))
    assert _run("filter", path, "--megapixels", "0.02", "--out", tmp_path / "o").exit_code == 0
    large = _declared(tmp_path / "b.png", 20000, 20000)
    assert "broken" in _line(_run("filter", large, "--megapixels", "401", "--out", tmp_path / "o")), "it is decoded"


def test_an_image_of_width_0_in_a_bag(tmp_path: Path, inputs: Path) -> None:
    raw = (inputs / "plain" / "dive.mcap").read_bytes()
    head = struct.pack("<II", SIZE[1], SIZE[0])
    assert raw.count(head) == 4
    path = tmp_path / "x.mcap"
    path.write_bytes(raw.replace(head, struct.pack("<II", SIZE[1], 0)))
    with pytest.raises(SignumError, match="frame 0: a picture of 0x120 pixels; expected"):
        list(open_source(path))


@pytest.mark.parametrize("way", ["pipe", "device", "folder", "empty"])
@pytest.mark.parametrize("victim", ["npy/dive.npy", "png/a.png", "folder/2.png", "mp4/dive.mp4", "bag/dive.bag",
                                    "db3/dive/dive.db3", "plain/dive.mcap", "calibration/c.yaml", "navigation/n.csv"])
def test_what_is_no_file_is_refused_at_once(tmp_path: Path, inputs: Path, victim: str, way: str) -> None:
    kind = victim.split("/")[0]
    folder = tmp_path / "in"
    folder.mkdir()
    for file in (inputs / kind).rglob("*"):
        if file.is_file() and "pictures" not in file.parts:
            (folder / file.relative_to(inputs / kind)).parent.mkdir(parents=True, exist_ok=True)
            (folder / file.relative_to(inputs / kind)).write_bytes(file.read_bytes())
    path = tmp_path / "in" / victim.split("/", 1)[1]
    path.unlink()
    ways: dict[str, Callable[[], object]] = {
        "pipe": partial(os.mkfifo, path), "device": partial(path.symlink_to, "/dev/zero"), "folder": path.mkdir,
        "empty": path.touch}
    ways[way]()
    with pytest.raises(SignumError) as error:
        if kind == "calibration":
            read_mono(path)
        elif kind == "navigation":
            read_track(path)
        else:
            list(open_source(path.parent if kind in ("folder", "db3") else path))
    expected = {"pipe": "a pipe; expected", "device": "a device; expected", "folder": "", "empty": "empty"}[way]
    assert str(path) in str(error.value) and expected in str(error.value)


@pytest.mark.parametrize("value", ["inf", "nan", "1e308", "-inf"])
@pytest.mark.parametrize("option", [("mosaic", "--range"), ("mosaic", "--focal"), ("hold", "--range"),
                                    ("hold", "--seconds")])
def test_numbers_of_options_are_finite(tmp_path: Path, inputs: Path, option: tuple[str, str], value: str) -> None:
    command, name = option
    source = ["--source"] if command == "hold" else []
    result = _run(command, *source, inputs / "npy" / "dive.npy", name, value, "--out", tmp_path / "o")
    assert result.exit_code in (1, 2) and name in result.stderr and not (tmp_path / "o").exists()
    if result.exit_code == 1:
        assert f"{name} is {float(value):g}; expected a number" in _line(result)


def test_an_unexpected_error_is_one_line_and_a_log(tmp_path: Path, inputs: Path, monkeypatch: pytest.MonkeyPatch
                                                  ) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("deep inside")

    monkeypatch.setattr(filter_command, "stage_panel", broken)
    out = tmp_path / "o[/red]"
    with pytest.raises(ZeroDivisionError):
        CliRunner().invoke(APP, ["filter", str(inputs / "png" / "a.png"), "--out", str(out)], catch_exceptions=False)
    monkeypatch.delenv(commands.RAISE)
    line = _line(_run("filter", inputs / "png" / "a.png", "--out", out))
    assert "unexpected ZeroDivisionError" in line and str(out / commands.LOG) in line
    log = (out / commands.LOG).read_text()
    assert "Traceback" in log and "deep inside" in log and str(inputs / "png" / "a.png") in log


def test_a_file_that_may_not_be_read_needs_no_other_output(tmp_path: Path, inputs: Path,
                                                           monkeypatch: pytest.MonkeyPatch) -> None:
    picture, out = inputs / "png" / "a.png", tmp_path / "o"
    for path, advice in ((picture, "mend that"), (out / "sign.png", "mend that, or choose another --out")):
        def refused(*_: object, path: Path = path) -> None:
            raise PermissionError(errno.EACCES, "Permission denied", str(path))

        monkeypatch.setattr(filter_command, "stage_panel", refused)
        assert _line(_run("filter", picture, "--out", out)).endswith(f"{path}: Permission denied; {advice}")


def test_an_unexpected_error_of_a_report_is_logged_beside_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(folder_report, "write_report", broken)
    monkeypatch.delenv(commands.RAISE)
    assert str(tmp_path / commands.LOG) in _line(_run("report", tmp_path)) and (tmp_path / commands.LOG).exists()


def test_an_empty_output_is_not_the_current_folder(tmp_path: Path, inputs: Path, monkeypatch: pytest.MonkeyPatch
                                                   ) -> None:
    monkeypatch.chdir(tmp_path)
    result = _run("filter", inputs / "png" / "a.png", "--out", "")
    assert result.exit_code == 2 and "name a folder" in result.stderr and not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["o[/red]", "[bold]o", ":smile:", "o [link=x]"])
def test_no_path_is_read_as_markup(tmp_path: Path, inputs: Path, name: str) -> None:
    result = _run("filter", inputs / "png" / "a.png", "--out", tmp_path / name)
    assert result.exit_code == 0 and f"{tmp_path / name}/sign.png: 160x120" in result.stdout
    assert name in _line(_run("filter", tmp_path / f"{name}.png", "--out", tmp_path / "o"))


def test_names_that_are_not_utf8_or_control_a_terminal(tmp_path: Path, inputs: Path) -> None:
    for file in sorted((inputs / "folder").glob("*.png")):
        name = {"1": "\udcff1", "2": "\x1b[31m2"}.get(file.stem, file.stem)
        (tmp_path / f"{name}.png").write_bytes(file.read_bytes())
    assert {f.name for f in open_source(tmp_path)} == {"0", "3", "\x1b[31m2", "\\xff1"}
    (tmp_path / "0.png").write_bytes(b"x")
    assert "\x1b" not in _line(_run("track", tmp_path / "\x1b[31m2", "--out", tmp_path / "o"))
    assert "UTF-8" in _line(_run("filter", inputs / "png" / "a.png", "--out", tmp_path / "\udcff"))
    video = tmp_path / "\udcff.mp4"
    video.write_bytes((inputs / "mp4" / "dive.mp4").read_bytes())
    assert len(list(open_source(video))) == 4


def test_a_failing_write_names_the_file(tmp_path: Path, inputs: Path) -> None:
    pid = os.fork()
    if not pid:
        import resource

        resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300))
        result = _run("track", inputs / "npy" / "dive.npy", "--window", "32", "--out", tmp_path / "o")
        said = [line for line in result.stderr.splitlines() if line.startswith("signum: ")]
        os._exit(0 if result.exit_code == 1 and len(said) == 1 and f"{tmp_path / 'o'}/" in said[0] else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0


TEXTS = "=1+1", "+x", "-x", "@SUM(A1)", "\tx", "\rx", "'=x", "''-", "'x", "-", "--1", "=", "a=b", "-1-1", \
    "+1+cmd|' /C calc'!A0"
NUMBERS = "-1.5", "+2", "-1e-3", "0", "-.5", "-inf", ".5"


def test_cells_that_a_spreadsheet_would_run_are_text_and_read_back_the_same(tmp_path: Path) -> None:
    table = Table(tmp_path / "t.csv", ("frame", "x_px", "n"))
    for text in TEXTS:
        table.write((text, -1.5, -3))
    for text in NUMBERS:
        table.write((text, text, 0))
    table.close()
    with (tmp_path / "t.csv").open(newline="") as file:
        raw = list(csv.reader(file))[1:]
    assert not [row[0] for row in raw[:len(TEXTS)] if row[0][0] in "=+-@\t\r"]
    assert [row[1:] for row in raw[:len(TEXTS)]] == [["-1.5", "-3"]] * len(TEXTS)
    assert [row[0] for row in raw[len(TEXTS):]] == list(NUMBERS), "numbers stay numbers"
    assert read_table(tmp_path / "t.csv").text["frame"] == [*TEXTS, *NUMBERS]
    (tmp_path / "n.csv").write_text("frame,x,y\n'=1+1,1,2\n'+a,-3,-4\n")
    assert read_track(tmp_path / "n.csv").positions == {"=1+1": 1 - 2j, "+a": -3 + 4j}


@pytest.mark.parametrize("ending", ["x.mcap", "x.MCAP"])
@pytest.mark.parametrize("part", ["chunk", "data", "summary"])
def test_a_checksum_of_an_mcap_that_does_not_agree_is_said(tmp_path: Path, inputs: Path, part: str, ending: str
                                                           ) -> None:
    raw = bytearray((inputs / "mcap" / "dive.mcap").read_bytes())
    assert len(list(open_source(inputs / "mcap" / "dive.mcap"))) == 4
    at = {"chunk": raw.index(frames()[1].tobytes()) + 50, "data": 20, "summary": len(raw) - 60}[part]
    raw[at] ^= 1
    path = tmp_path / ending
    path.write_bytes(bytes(raw))
    says = {"chunk": "checksum", "data": "checksum of data", "summary": "checksum of summary"}[part]
    with pytest.raises(SignumError, match=says) as error:
        list(open_source(path))
    assert str(path) in str(error.value)


def test_a_bag_that_lists_more_frames_than_it_has_is_said(tmp_path: Path, inputs: Path) -> None:
    raw = (inputs / "plain" / "dive.mcap").read_bytes()
    # The record of statistics: 42 bytes, the length of the map, channel and number of its messages.
    statistics = raw.rindex(b"\x0b" + struct.pack("<Q", 56))
    edited = bytearray(raw)
    edited[statistics + 9 + 48] = 6
    path = tmp_path / "x.mcap"
    path.write_bytes(bytes(edited))
    with pytest.raises(SignumError, match="lists 6 frames, 4 could be read"):
        list(open_source(path))


def test_a_png_whose_checksum_does_not_agree_is_broken(tmp_path: Path, inputs: Path) -> None:
    raw = bytearray((inputs / "png" / "a.png").read_bytes())
    raw[len(raw) // 2] ^= 1
    (tmp_path / "a.png").write_bytes(bytes(raw))
    with pytest.raises(SignumError, match="broken"):
        list(open_source(tmp_path / "a.png"))


def test_rows_that_a_report_leaves_out_are_said(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("frame,x\n0,inf\n1,2,3\n2,1e308\n3,4\n")
    table = read_table(tmp_path / "t.csv")
    assert table.rows == 3 and np.isfinite(table.numbers("x")).tolist() == [False, False, True]
    result = _run("report", tmp_path)
    assert result.exit_code == 0 and "1 of 4 rows" in result.stderr and "2 cells are no finite numbers" in result.stderr
