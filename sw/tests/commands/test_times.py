# SPDX-License-Identifier: Apache-2.0
"""Tables carry the time that the source gives each frame, not one counted by a rate."""

import csv
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from typer.testing import CliRunner

from signum.commands.cli import application
from signum.common.arrays import Image
from signum.common.files import write_picture
from signum.tables.schemas import DISPARITY, DRIFT, FLOW, FOLLOW, GOTO, NAVIGATE, POSES, TRACK
from signum.world.seafloor import photograph

TIMES_MS = 0, 200, 300, 1300
SIZE = 192, 144
FLOOR = photograph("gravel")


def _view(k: int) -> Image:
    """The floor from `k` steps further along."""
    return np.ascontiguousarray(FLOOR[60 : 60 + SIZE[1], 40 + 6 * k : 40 + 6 * k + SIZE[0]])


@pytest.fixture(scope="module")
def dive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A video whose frames are not equally far apart in time."""
    path = tmp_path_factory.mktemp("times") / "dive.mp4"
    with av.open(str(path), "w") as file:
        stream = file.add_stream("mpeg4", rate=30)
        stream.width, stream.height, stream.pix_fmt = *SIZE, "yuv420p"
        stream.codec_context.time_base, stream.bit_rate = Fraction(1, 1000), 8_000_000
        for k, t in enumerate(TIMES_MS):
            frame = av.VideoFrame.from_ndarray(np.dstack([_view(k)] * 3), format="bgr24")
            frame.pts, frame.time_base = t, Fraction(1, 1000)
            file.mux(stream.encode(frame))
        file.mux(stream.encode())
    return path


def _rows(path: Path, columns: tuple[str, ...]) -> dict[str, dict[str, str]]:
    """The last row of each frame."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == columns
    return {r.get("frame") or r["frame_b"]: r for r in rows}


def _run(*arguments: str | Path) -> None:
    result = CliRunner().invoke(application(), [str(a) for a in arguments])
    assert result.exit_code == 0, result.output


def _times(rows: dict[str, dict[str, str]]) -> list[float]:
    return [float(r["time_s"]) for r in rows.values()]


TIMES = pytest.approx([t / 1000 for t in TIMES_MS], abs=1e-6)


def test_track(dive: Path, tmp_path: Path) -> None:
    _run("track", dive, "--window", "32", "--features", "6", "--out", tmp_path)
    assert _times(_rows(tmp_path / "track.csv", TRACK)) == TIMES
    assert _times(_rows(tmp_path / "drift.csv", DRIFT)) == TIMES


def test_flow(dive: Path, tmp_path: Path) -> None:
    _run("flow", dive, "--window", "32", "--out", tmp_path)
    rows = _rows(tmp_path / "flow.csv", FLOW)
    assert _times(rows) == pytest.approx([0.2, 0.3, 1.3])
    assert [float(r["step_s"]) for r in rows.values()] == pytest.approx([0.2, 0.1, 1.0])


def test_stereo(dive: Path, tmp_path: Path) -> None:
    _run("stereo", dive, dive, "--least", "-8", "--most", "8", "--step", "32", "--out", tmp_path)
    assert _times(_rows(tmp_path / "disparity.csv", DISPARITY)) == TIMES


def test_mosaic(dive: Path, tmp_path: Path) -> None:
    _run("mosaic", dive, "--window", "32", "--no-live", "--out", tmp_path)
    assert _times(_rows(tmp_path / "poses.csv", POSES)) == TIMES


def test_navigate(dive: Path, tmp_path: Path) -> None:
    write_picture(tmp_path / "mosaic.png", FLOOR)
    _run("navigate", tmp_path / "mosaic.png", dive, "--window", "32", "--goto", "120,110", "--out", tmp_path / "out")
    rows = _rows(tmp_path / "out" / "navigate.csv", NAVIGATE)
    assert _times(rows) == TIMES and all(int(r["confidence"]) > 0 for r in rows.values())
    assert _times(_rows(tmp_path / "out" / "goto.csv", GOTO)) == TIMES


def test_follow(dive: Path, tmp_path: Path) -> None:
    _run("follow", "--source", dive, "--out", tmp_path)
    assert _times(_rows(tmp_path / "follow.csv", FOLLOW)) == pytest.approx([0, 0.2, 0.3, 1.3], abs=5e-4)


def test_follow_ends_by_the_frames_own_time(dive: Path, tmp_path: Path) -> None:
    _run("follow", "--source", dive, "--seconds", "1", "--out", tmp_path)
    assert _times(_rows(tmp_path / "follow.csv", FOLLOW)) == pytest.approx([0, 0.2, 0.3], abs=5e-4)


def test_a_source_without_times_leaves_them_empty(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    for k in range(2):
        write_picture(tmp_path / f"in/{k}.png", _view(k))
    _run("track", tmp_path / "in", "--window", "32", "--features", "6", "--out", tmp_path / "out")
    assert {r["time_s"] for r in _rows(tmp_path / "out" / "track.csv", TRACK).values()} == {""}
