# SPDX-License-Identifier: Apache-2.0
"""From a folder with navigation to a GeoTIFF: every frame is found at its logged place by an independent reader, and a
log that would lead to a wrong place ends the command with one line and status 1.
"""

import csv
import shutil
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import pytest
import rasterio
from PIL import ExifTags
from PIL import Image as PilImage
from typer.testing import CliRunner, Result

from signum.commands.cli import application
from signum.commands.session import Session
from signum.common.arrays import Image
from signum.common.files import write_picture
from signum.geometry.earth import project
from signum.world.seafloor import photograph

FRAMES, SIZE, STEP, PIXEL = 6, (160, 120), (40, 12), 0.002
E0, N0 = 690_000.0, 6_090_000.0
LATITUDE, LONGITUDE = -35.31, 149.05
BOARD = "--window", "32", "--no-live", "--columns", "single"
FLOOR = photograph("gravel")
EAST = [E0 + PIXEL * STEP[0] * k for k in range(FRAMES)]
NORTH = [N0 - PIXEL * STEP[1] * k for k in range(FRAMES)]
DEGREES = [(LATITUDE - 1.8e-8 * STEP[1] * k, LONGITUDE + 2.2e-8 * STEP[0] * k) for k in range(FRAMES)]
"""Of the frames' centres, for a pixel of 2 mm; frames are north up."""


class Made(NamedTuple):
    """A survey without a place: its frames, and the folder of its mosaic."""

    frames: Path
    out: Path


def _view(k: int) -> Image:
    (x, y), (width, height) = STEP, SIZE
    return np.ascontiguousarray(FLOOR[60 + k * y:60 + k * y + height, 40 + k * x:40 + k * x + width])


def _mosaic(*arguments: str | Path) -> Result:
    return CliRunner().invoke(application("mosaic"), ["mosaic", *map(str, arguments), *BOARD])


def _log(path: Path, head: str, rows: list[str]) -> Path:
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


@pytest.fixture(scope="module", autouse=True)
def no_page() -> Iterator[None]:
    """The page, of which there is nothing to see here, would take three quarters of the time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Session, "report_folder", lambda run: None)
        yield


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Measured once; each test continues a copy, which takes the blending alone."""
    place = tmp_path_factory.mktemp("georeference")
    (place / "in").mkdir()
    for k in range(FRAMES):
        write_picture(place / f"in/{k:03d}.png", _view(k))
    result = _mosaic(place / "in", "--out", place / "out")
    assert result.exit_code == 0 and not (place / "out" / "mosaic.tif").exists(), result.output
    # Every frame once for the light, once for the seams together, and once for the bands.
    assert f" {2 * FRAMES + 1}/? " in next(line for line in result.stderr.splitlines() if "blending" in line)
    return Made(place / "in", place / "out")


@pytest.fixture
def out(made: Made, tmp_path: Path) -> Path:
    shutil.copytree(made.out, tmp_path / "out")
    return tmp_path / "out"


def _found(path: Path, east: list[float], north: list[float]) -> float:
    """The largest distance, pixels, of the middle of a frame in the GeoTIFF from its logged place."""
    far = []
    with rasterio.open(path) as file:
        seen = file.read(1)
        for k, (e, n) in enumerate(zip(east, north, strict=True)):
            row, column = file.index(e + 0.5 * PIXEL, n - 0.5 * PIXEL)  # the middle lies between pixels
            (width, height), view = SIZE, _view(k)
            middle = view[height // 2 - 20:height // 2 + 20, width // 2 - 20:width // 2 + 20]
            likeness = cv2.matchTemplate(seen[row - 28:row + 28, column - 28:column + 28], middle, cv2.TM_CCOEFF_NORMED)
            _, best, _, (x, y) = cv2.minMaxLoc(likeness)
            assert best > 0.8, f"frame {k} is not there"
            far.append(max(abs(x - 8), abs(y - 8)))
    return max(far)


def _rows(kind: str) -> tuple[str, list[str]]:
    """A log of a kind: head and rows."""
    places = [f"{e:.4f},{n:.4f}" for e, n in zip(EAST, NORTH, strict=True)]
    if kind == "time":
        return "time_s,east_m,north_m", [f"{1e4 + 0.1 * k:.1f},{p}" for k, p in enumerate(places)]
    if kind == "degrees":
        return "frame;latitude;longitude", [f"{k};{a:.10f};{b:.10f}" for k, (a, b) in enumerate(DEGREES)]
    if kind == "nan":
        places[4] = f"nan,{NORTH[4]}"
    if kind == "stray":
        places[2] = f"{EAST[2] + 500},{NORTH[2]}"
    return "frame,east_m,north_m", [f"{k:03d}.png,{p}" for k, p in enumerate(places)]


@pytest.mark.parametrize(("kind", "options", "says"), [
    ("frame", ("--epsg", "32755"), "laid by 6 fixes for 6 frames"), ("degrees", (), "its middle is at 35.31"),
    ("nan", ("--epsg", "32755"), "frame 004: east_m is nan"), ("stray", ("--epsg", "32755"), "left out: 002 (500 m)"),
    ("time", ("--epsg", "32755", "--rate", "10", "--start", "10000", "--cog"), "EPSG 32755, WGS 84 / UTM zone 55S"),
    ("frame", (), "no --epsg was given")])
def test_every_frame_lies_where_the_log_has_it(made: Made, out: Path, kind: str, options: tuple[str, ...], says: str
                                               ) -> None:
    log = _log(out.parent / "n.csv", *_rows(kind))
    result = _mosaic(made.frames, "--navigation", log, *options, "--out", out)
    assert result.exit_code == 0 and says in result.output, result.output
    with rasterio.open(out / "mosaic.tif") as file:
        assert (file.crs.to_epsg() == 32755) == bool("--epsg" in options or kind == "degrees")
        assert (file.tags(ns="IMAGE_STRUCTURE").get("LAYOUT") == "COG") == ("--cog" in options)
        assert file.transform.a == pytest.approx(PIXEL, rel=0.01)
    east, north = EAST, NORTH
    if kind == "degrees":
        metres = project(*np.array(DEGREES).T)
        east, north = metres.east.tolist(), metres.north.tolist()
    assert _found(out / "mosaic.tif", east, north) <= 1
    exported = CliRunner().invoke(application("export"), ["export", str(out), "--rate", "10"])
    assert exported.exit_code == 0, exported.output
    poses = np.loadtxt(out / "poses.tum")
    assert np.abs(poses[:, 1:3] - np.stack([east, north], 1)).max() < 1.5 * PIXEL, "by another way than the picture's"
    assert np.degrees(2 * np.arctan2(poses[:, 6], poses[:, 7])) == pytest.approx(90, abs=1.5), (
        "grid north is up to 1.2 degrees off")


def test_the_verilated_board_lays_it_by_time_too(made: Made, tmp_path: Path) -> None:
    """The same edge of two frames, and the same places in the GeoTIFF, by a log with times."""
    out = tmp_path / "out"
    (tmp_path / "in").mkdir()
    for k in range(2):
        shutil.copy(made.frames / f"{k:03d}.png", tmp_path / "in")
    result = _mosaic(tmp_path / "in", "--navigation", _log(tmp_path / "n.csv", *_rows("time")), "--epsg", "32755",
                     "--rate", "10", "--start", "10000", "--board", "verilated", "--out", out)
    assert result.exit_code == 0 and "laid by 2 fixes" in result.output, result.output
    edges = [(folder / "edges.csv").read_text().splitlines()[:2] for folder in (out, made.out)]
    assert edges[0] == edges[1]
    assert _found(out / "mosaic.tif", EAST[:2], NORTH[:2]) <= 1


@pytest.mark.parametrize(("kind", "options", "says"), [
    ("wrong degrees", (), "east_m and north_m look like degrees"),
    ("wrong degrees", ("--epsg", "32755"), "east_m and north_m look like degrees"),
    ("frame", ("--epsg", "4326"), "in degrees: a mosaic has metres"),
    ("frame", ("--epsg", "27700"), "outside of EPSG 27700"),
    ("time", (), "has frames without times: give their --rate"),
    ("time", ("--rate", "10"), "no frame lies within the log"),
    ("frame", ("--start", "0"), "--start is of a --navigation log by time"),
    ("frame", ("--exif",), "two logs"), ("frame", ("--range", "2", "--focal", "10"), "covers 0.002 m, by --range")])
def test_a_wrong_place_is_an_error(made: Made, out: Path, kind: str, options: tuple[str, ...], says: str) -> None:
    head, rows = _rows("frame" if kind == "wrong degrees" else kind)
    if kind == "wrong degrees":
        rows = [f"{k:03d},{b:.10f},{a:.10f}" for k, (a, b) in enumerate(DEGREES)]
    log = _log(out.parent / "n.csv", head, rows)
    result = _mosaic(made.frames, "--navigation", log, *options, "--out", out)
    line = [text for text in result.stderr.splitlines() if text.startswith("signum: ")]
    assert result.exit_code == 1 and len(line) == 1 and says in line[0], result.output
    assert not (out / "mosaic.tif").exists() and not (out / "mosaic.pgw").exists()


def _times(out: Path) -> list[str]:
    with (out / "poses.csv").open(newline="") as file:
        return [row["time_s"] for row in csv.DictReader(file)]


def test_a_continued_survey_keeps_the_times(made: Made, tmp_path: Path) -> None:
    """Four frames, then all six, then the first one gone from the folder: the same bytes as in one go."""
    frames, log = tmp_path / "in", _log(tmp_path / "n.csv", *_rows("time"))
    options = "--navigation", log, "--epsg", "32755", "--rate", "10", "--start", "10000", "--out"
    shutil.copytree(made.frames, frames)
    assert _mosaic(frames, *options, tmp_path / "whole").exit_code == 0
    assert _times(tmp_path / "whole") == [f"{0.1 * k:.6f}" for k in range(FRAMES)]
    away = [frames / f"{k:03d}.png" for k in (4, 5)]
    for path in away:
        path.rename(tmp_path / path.name)
    assert _mosaic(frames, *options, tmp_path / "parts").exit_code == 0
    for path in away:
        (tmp_path / path.name).rename(path)
    assert _mosaic(frames, *options, tmp_path / "parts").exit_code == 0
    names = "poses.csv", "mosaic.tif", "mosaic.png", "mosaic.pgw", "edges.csv"
    assert [n for n in names if (tmp_path / "whole" / n).read_bytes() != (tmp_path / "parts" / n).read_bytes()] == []
    (frames / "005.png").unlink()
    assert _mosaic(frames, *options, tmp_path / "parts").exit_code == 0
    assert [n for n in names if (tmp_path / "whole" / n).read_bytes() != (tmp_path / "parts" / n).read_bytes()] == []


def test_a_frame_that_comes_later_between_others_is_added(made: Made, tmp_path: Path) -> None:
    frames = tmp_path / "in"
    shutil.copytree(made.frames, frames)
    (frames / "002.png").rename(tmp_path / "002.png")
    assert _mosaic(frames, "--out", tmp_path / "out").exit_code == 0 and len(_times(tmp_path / "out")) == FRAMES - 1
    (tmp_path / "002.png").rename(frames / "002.png")
    assert _mosaic(frames, "--out", tmp_path / "out").exit_code == 0 and len(_times(tmp_path / "out")) == FRAMES


def _photograph(path: Path, k: int) -> None:
    """A JPEG with GPS position and time, as a camera that is ten hours ahead of UTC writes it."""
    picture = PilImage.fromarray(_view(k))
    tags = picture.getexif()
    tags.get_ifd(ExifTags.IFD.Exif).update({ExifTags.Base.DateTimeOriginal: f"2026:03:01 20:00:{k:02d}",
                                            ExifTags.Base.OffsetTimeOriginal: "+10:00"})
    parts = []
    for value in map(abs, DEGREES[k]):
        seconds = Fraction(value % (1 / 60) * 3600).limit_denominator(10**8)
        parts.append((int(value), int(value * 60 % 60), seconds))
    tags.get_ifd(ExifTags.IFD.GPSInfo).update({
        ExifTags.GPS.GPSLatitudeRef: "S", ExifTags.GPS.GPSLatitude: parts[0], ExifTags.GPS.GPSLongitudeRef: "E",
        ExifTags.GPS.GPSLongitude: parts[1]})
    picture.save(path, quality=97, exif=tags)


def test_position_and_time_of_photographs(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    for k in range(FRAMES):
        _photograph(tmp_path / f"in/p{k}.jpg", k)
    result = _mosaic(tmp_path / "in", "--exif", "--out", tmp_path / "out")
    assert result.exit_code == 0 and "EPSG 32755" in result.output, result.output
    metres = project(*np.array(DEGREES).T)
    assert _found(tmp_path / "out/mosaic.tif", metres.east.tolist(), metres.north.tolist()) <= 1
    assert _times(tmp_path / "out") == [f"{1772359200 + k}.000000" for k in range(FRAMES)], "UTC"
    before = (tmp_path / "out/mosaic.pgw").read_text()
    rows = [f"2026-03-01T10:00:{k:02d}Z,{a:.10f},{b:.10f}" for k, (a, b) in enumerate(DEGREES)]
    log = _log(tmp_path / "n.csv", "utc,lat,lon", rows)
    result = _mosaic(tmp_path / "in", "--navigation", log, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    after = (tmp_path / "out/mosaic.pgw").read_text()
    assert list(map(float, after.split())) == pytest.approx(list(map(float, before.split())), abs=1e-3)


def test_exif_that_is_not_there(made: Made, out: Path) -> None:
    result = _mosaic(made.frames, "--exif", "--out", out)
    assert result.exit_code == 1 and "0 of the 6 pictures have a GPS position" in result.stderr
