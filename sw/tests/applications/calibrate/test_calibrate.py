# SPDX-License-Identifier: Apache-2.0
"""Calibration recovers cameras that are known: from rendered pictures of boards, and from corners alone, in thin
coverage and through a flat port."""

from __future__ import annotations

import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from signum.applications.calibrate.solve import LensModel, fit_lens, fit_rig
from signum.applications.calibrate.target import Sighting, SquareBoard, TargetKind
from signum.applications.calibrate.views import choose, look
from signum.commands.cli import application
from signum.common.arrays import Floats, Image
from signum.common.errors import SignumError
from signum.common.files import write_picture
from signum.geometry.coverage import hints
from signum.geometry.lens import Lens
from signum.sources.files import ArraySource
from signum.sources.open import open_lens, open_rig, open_source
from tests.applications.calibrate.scene import (
    CHARUCO,
    CHESSBOARD,
    FISHEYE,
    NARROW,
    SIZE,
    Pose,
    Scene,
    beside,
    chessboard_points,
    poses,
    through_port,
    undistortion_error,
)
from tests.report.heads import check_head

TURN = np.asarray(cv2.Rodrigues(np.array([0.01, -0.02, 0.005]))[0], np.float64)
MOVE = -TURN @ np.array([0.08, 0.001, 0.002])
RIGHT = Lens(NARROW.matrix + np.array([[3.0, 0, -4], [0, 3.0, 5], [0, 0, 0]]), NARROW.distortion * 0.9, SIZE)
"""The second camera of a pair sits 8 cm to the right of the first."""


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(application(), [str(a) for a in arguments])


def _corners(lens: Lens, places: list[Pose], noise: float = 0.05, seed: int = 0) -> list[Sighting]:
    """The corners of a chessboard, as far as they fall on the picture, with noise."""
    rng, points = np.random.default_rng(seed), chessboard_points(CHESSBOARD)
    out = []
    for turn, move in places:
        seen = lens.project(points, turn, move) + rng.normal(0, noise, (len(points), 2))
        kept = np.flatnonzero(((seen >= 0) & (seen <= np.array(SIZE) - 1)).all(1))
        out.append(Sighting(kept, points[kept], seen[kept]))
    return [s for s in out if len(s.ids) >= 12]


def _off(found: Lens, true: Lens) -> tuple[float, float]:
    """Errors of the focal lengths, as a share, and of the principal point, pixels."""
    off = np.abs(found.matrix - true.matrix)
    return float(max(off[0, 0], off[1, 1]) / true.focal), float(max(off[0, 2], off[1, 2]))


def test_a_camera_from_pictures_of_a_charuco_board(tmp_path: Path) -> None:
    scene = Scene(NARROW, CHARUCO)
    (tmp_path / "in").mkdir()
    for k, pose in enumerate(poses(14, 1, 0.36, 0.3, 0.48)):
        write_picture(tmp_path / "in" / f"{k}.png", scene.picture(pose))
    write_picture(tmp_path / "in" / "99.png", np.full(SIZE[::-1], 90, np.uint8))
    out = tmp_path / "out"
    result = _run("calibrate", tmp_path / "in", "--marker", "0.0225", "--out", out)
    assert result.exit_code == 0, result.output
    lens = open_lens(out / "calibration.yaml")
    focal, centre = _off(lens, NARROW)
    assert lens.size == SIZE and not lens.fisheye and focal < 0.003 and centre < 1.0
    assert undistortion_error(lens, NARROW) < 0.5
    assert "the board in 14 of 15 frames" in result.stderr
    check_head(out / "report.html", "calibrate", str(tmp_path / "in"), board=False)
    page = (out / "report.html").read_text()
    assert page.count("data:image/png") == 4 and "://" not in page and "field of view" in page
    assert len(list(open_source(tmp_path / "in", out / "calibration.yaml"))) == 15, "--calibration takes it"


def test_a_fisheye_camera_from_pictures() -> None:
    scene = Scene(FISHEYE, CHARUCO)
    views = [s for p in poses(14, 3, 0.8, 0.14, 0.22, 30.0) if (s := CHARUCO.find(scene.picture(p))) is not None]
    fit = fit_lens(views, SIZE, LensModel.fisheye)
    focal, centre = _off(fit.lens, FISHEYE)
    assert len(fit.used) >= 10 and fit.lens.fisheye and focal < 0.005 and centre < 1.0 and fit.rms_px < 0.25
    assert undistortion_error(fit.lens, FISHEYE) < 0.5
    pinhole = fit_lens(views, SIZE, LensModel.pinhole)
    assert undistortion_error(pinhole.lens, FISHEYE) > 1.0, "the pinhole model is no match for this lens"


def test_a_pair_from_pictures_of_a_chessboard(tmp_path: Path) -> None:
    scenes = Scene(NARROW, CHESSBOARD, 1), Scene(RIGHT, CHESSBOARD, 2)
    for side in ("left", "right"):
        (tmp_path / side).mkdir()
    for k, pose in enumerate(poses(7, 5, 0.2, 0.5, 0.7, 35.0)):
        for side, scene, place in zip(("left", "right"), scenes, (pose, beside(pose, TURN, MOVE)), strict=True):
            write_picture(tmp_path / side / f"{k}.png", scene.picture(place))
    out = tmp_path / "out"
    result = _run("calibrate", tmp_path / "left", "--right", tmp_path / "right", "--target", "chessboard", "--across",
                  "10", "--down", "7", "--out", out)
    assert result.exit_code == 0, result.output
    rig = open_rig(out / "calibration.yaml")
    assert np.linalg.norm(rig.move) == pytest.approx(0.08, abs=0.0008)
    points = np.random.default_rng(0).uniform((-0.15, -0.1, 0.5), (0.2, 0.1, 0.9), (100, 3))
    seen = rig.first.rays(NARROW.project(points)), rig.second.rays(RIGHT.project(points, TURN, MOVE))
    found = np.asarray(cv2.triangulatePoints(np.eye(3, 4), np.c_[rig.turn, rig.move], seen[0].T, seen[1].T), np.float64)
    ranges = np.linalg.norm(found[:3] / found[3], axis=0) / np.linalg.norm(points, axis=1)
    assert np.abs(ranges - 1).max() < 0.01
    rows = re.search(r"rows of the rectified pair within ([\d.]+) px", result.stdout)
    assert rows and float(rows[1]) < 0.15
    page = (out / "report.html").read_text()
    assert page.count("data:image/png") == 9 and "The pair" in page and "Only 7 views" in page


def test_corners_alone_give_the_camera_to_a_few_hundredths_of_a_pixel() -> None:
    for lens, model, places in ((NARROW, LensModel.pinhole, poses(20, 7, 0.36, 0.3, 0.5)),
                                (NARROW, LensModel.rational, poses(20, 7, 0.36, 0.3, 0.5)),
                                (FISHEYE, LensModel.fisheye, poses(20, 8, 0.8, 0.15, 0.25, 30.0))):
        fit = fit_lens(_corners(lens, places), SIZE, model)
        assert _off(fit.lens, lens)[0] < 0.001 and fit.rms_px == pytest.approx(0.05 * np.sqrt(2), rel=0.1)
        assert undistortion_error(fit.lens, lens) < 0.25, model
        assert not np.isfinite(fit.focal_error_px) or abs(fit.lens.focal - lens.focal) < 4 * fit.focal_error_px


def test_a_pair_of_fisheye_cameras() -> None:
    places = poses(16, 9, 0.5, 0.2, 0.3, 30.0)
    views = []
    points = chessboard_points(CHESSBOARD)
    for pose in places:
        one, two = (lens_.project(points, *p) for lens_, p in ((FISHEYE, pose), (FISHEYE, beside(pose, TURN, MOVE))))
        kept = np.flatnonzero(((np.c_[one, two] >= 0) & (np.c_[one, two] <= np.array([*SIZE, *SIZE]) - 1)).all(1))
        if len(kept) >= 12:
            views.append((Sighting(kept, points[kept], one[kept]), Sighting(kept, points[kept], two[kept])))
    views[2] = views[2][0], Sighting(views[2][1].ids, views[2][1].points,
                                          views[2][1].corners + np.array([9.0, 4.0]))
    fit = fit_rig(views, FISHEYE, FISHEYE)
    assert 2 not in fit.used and len(fit.used) == len(views) - 1, "a pair of other moments is left out"
    assert np.allclose(fit.rig.move, MOVE, atol=1e-5) and np.allclose(fit.rig.turn, TURN, atol=1e-5)
    assert fit.rms_px < 0.01 and fit.rows_px < 0.01


def test_views_that_do_not_fit_are_left_out() -> None:
    views = _corners(NARROW, poses(20, 7, 0.36, 0.3, 0.5))
    bent = views[4].corners + 4 * np.sin(views[4].points[:, :1] * 40)
    views[4] = Sighting(views[4].ids, views[4].points, bent)
    fit = fit_lens(views, SIZE, LensModel.pinhole)
    assert 4 not in fit.used and len(fit.used) >= len(views) - 2
    assert undistortion_error(fit.lens, NARROW) < 0.25
    wrong = views[7].corners.copy()
    wrong[3] += 5.0
    views[7] = Sighting(views[7].ids, views[7].points, wrong)
    again = fit_lens(views, SIZE, LensModel.pinhole)
    assert 7 in again.used and len(again.views[7].ids) == len(wrong) - 1, "only the corner is left out"
    with pytest.raises(SignumError, match="3 views of the board"):
        fit_lens(views[:3], SIZE, LensModel.pinhole)


def _hints(lens: Lens, places: list[Pose]) -> tuple[list[str], float]:
    """What is said of a calibration from these places, and the error of its undistortion."""
    views = _corners(lens, places)
    fit = fit_lens(views, SIZE, LensModel.pinhole)
    corners: Floats = np.concatenate([fit.views[k].corners for k in fit.used])
    return hints(corners, SIZE, fit.tilts_deg()[fit.used], fit.rms_px), undistortion_error(fit.lens, lens)


def test_thin_coverage_is_said_and_is_worse() -> None:
    said, good = _hints(NARROW, poses(20, 7, 0.36, 0.3, 0.5))
    assert not said and good < 0.25
    middle, off = _hints(NARROW, poses(20, 7, 0.05, 0.8, 1.0))
    assert any("in all directions" in h or "bring it also to the upper left" in h for h in middle)
    assert any("beyond that the distortion is a guess" in h for h in middle) and off > 3 * good
    aside = [(turn, move + np.array([0.2, 0.14, 0])) for turn, move in poses(20, 7, 0.05, 0.6, 0.7)]
    corner, off = _hints(NARROW, aside)
    assert any("upper left" in h and "lower right" not in h for h in corner) and off > 3 * good
    left, _ = _hints(NARROW, [(t, m) for t, m in poses(24, 7, 0.36, 0.3, 0.5) if (t @ [0.165, 0.12, 0] + m)[0] < 0.05])
    assert any("at the right edge" in h for h in left), left
    flat, _ = _hints(NARROW, poses(20, 7, 0.36, 0.3, 0.5, 3.0))
    assert any("Tilt it by 20 to 45 degrees" in h for h in flat)
    few, _ = _hints(NARROW, poses(8, 7, 0.36, 0.3, 0.5))
    assert any(h.startswith("Only 8 views") for h in few)


def _through_port(gap: float) -> tuple[float, list[tuple[float, float]]]:
    """A camera calibrated at 0.5 to 0.9 m through a flat port at `gap` metres: its focal length against that in air,
    and for a plane at 0.3, 0.7 and 5 m the largest residual in pixels and the error of its range in metres."""
    lens, points, views = Lens(NARROW.matrix, np.zeros(5), SIZE), chessboard_points(CHESSBOARD), []
    for turn, move in poses(24, 11, 0.27, 0.5, 0.9):
        seen = through_port(points @ turn.T + move, lens, gap)
        kept = np.flatnonzero(((seen >= 0) & (seen <= np.array(SIZE) - 1)).all(1))
        views.append(Sighting(kept, points[kept], seen[kept]))
    fit = fit_lens(views, SIZE, LensModel.pinhole)
    grid = np.stack(np.meshgrid(np.linspace(-0.4, 0.4, 9), np.linspace(-0.3, 0.3, 7)), -1).reshape(-1, 2)
    out = []
    for away in (0.3, 0.7, 5.0):
        plane = np.c_[grid * away, np.zeros(len(grid))]
        seen = through_port(plane + np.array([0, 0, away]), lens, gap)
        _, around, shift = cv2.solvePnP(plane, fit.lens.rays(seen), np.eye(3), None)
        place = np.asarray(around, np.float64).ravel(), np.asarray(shift, np.float64).ravel()
        off = seen - fit.lens.project(plane, *place)
        out.append((float(np.hypot(*off.T).max()), float(place[1][2] - away)))
    return fit.lens.focal / lens.focal, out


def test_a_flat_port_is_followed_near_the_ranges_of_the_calibration() -> None:
    """No single model is right at all ranges behind a flat port. The figures stand in docs/guides/calibrate.md."""
    for gap, near, middle, far in ((0.01, 0.5, 0.1, 0.5), (0.05, 1.6, 0.2, 1.8)):
        focal, errors = _through_port(gap)
        assert focal == pytest.approx(1.333, rel=0.006)
        assert errors[0][0] < near and errors[1][0] < middle and errors[2][0] < far, errors
        assert errors[2][0] > 3 * errors[1][0], "it grows away from the calibration's ranges"
        assert all(0.15 * gap < off < 0.42 * gap for _, off in errors), "ranges count from a place behind the pupil"


def test_views_that_differ_are_chosen() -> None:
    outline = np.array([[0.0, 0], [100, 0], [100, 70], [0, 70]])
    still = [outline + k * 0.5 for k in range(20)]
    moved = [outline + np.array([40 * k, 0]) for k in range(8)]
    assert len(choose(still, 480, 40)) == 1
    assert set(range(21, 28)) < set(choose([*still, *moved], 480, 40)) and len(choose([*still, *moved], 480, 40)) < 10
    assert choose(moved, 480, 2)[-1] == 7 and choose([], 480, 3) == []


class _FromEitherEnd(SquareBoard):
    """A board that is read from its other end in bright pictures, as a symmetric chessboard may be."""

    def find(self, picture: Image) -> Sighting:
        points = chessboard_points(self)
        corners = 400 * points[:, :2] + 20
        return Sighting(np.arange(len(points)), points, corners[::-1] if picture[0, 0] > 100 else corners)


def test_both_cameras_read_a_board_from_the_same_end() -> None:
    board = _FromEitherEnd(TargetKind.chessboard, (9, 7), 0.03, 0.02, "")
    dark, bright = (ArraySource([np.full((120, 160), level, np.uint8)] * 2) for level in (50, 150))
    for view, _ in look(board, (dark, bright)):
        assert view.shared is not None and np.allclose(view.shared[0].corners, view.shared[1].corners)
    with pytest.raises(SignumError, match="fewer frames"):
        list(look(board, (dark, ArraySource([np.full((120, 160), 9, np.uint8)]))))
    with pytest.raises(SignumError, match="pictures of one size"):
        list(look(board, (dark, ArraySource([np.full((100, 160), 9, np.uint8)] * 2))))


def test_a_board_that_is_laid_out_otherwise_is_found() -> None:
    older = SquareBoard(TargetKind.charuco, (8, 6), 0.03, 0.0225, "4X4_50", True)
    picture = np.asarray(cv2.GaussianBlur(older.draw(40), (0, 0), 1), np.uint8)
    asked = SquareBoard(TargetKind.charuco, (6, 8), 0.03, 0.0225, "5X5_100")
    assert asked.find(picture) is None
    found = asked.other([picture])
    assert found is not None and (found.squares, found.dictionary, found.legacy) == ((8, 6), "4X4_50", True)
    inner = SquareBoard(TargetKind.chessboard, (9, 6), 0.03, 0.02, "")
    counted = inner.other([np.asarray(cv2.GaussianBlur(CHESSBOARD.draw(30), (0, 0), 1), np.uint8)])
    assert counted is not None and counted.squares == CHESSBOARD.squares, "inner corners were counted"
    assert inner.other([np.full((200, 200), 90, np.uint8)]) is None


@pytest.mark.parametrize(("arguments", "says"), [
    (("--right", "{}"), "needs the left camera's pictures"), (("{}", "--marker", "0.04"), "a marker lies within"),
    (("{}", "--dictionary", "9X9_50"), "expected one of 4X4_50"), (("{}",), "no board in any of 2 frames"),
    (("{}", "--target", "chessboard"), "no board in any of 2 frames"),
    (("--across", "30", "--down", "30"), "needs 450 markers, 5X5_100 has 100"), (("0",), "record a video")])
def test_what_cannot_be_calibrated_is_one_line(tmp_path: Path, arguments: tuple[str, ...], says: str,
                                               monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "in").mkdir()
    for k in range(2):
        write_picture(tmp_path / "in" / f"{k}.png", np.full((120, 160), 90 + k, np.uint8))
    result = _run("calibrate", *(a.format(tmp_path / "in") for a in arguments), "--out", tmp_path / "out")
    lines = [line for line in result.stderr.splitlines() if line.startswith("signum: ")]
    assert result.exit_code == 1 and len(lines) == 1 and says in lines[0]


def test_a_board_is_drawn_for_printing(tmp_path: Path) -> None:
    result = _run("calibrate", "--across", "6", "--down", "5", "--out", tmp_path)
    assert result.exit_code == 0 and "6 x 5 squares of 30 mm" in result.stdout, result.output
    drawn = cv2.imread(str(tmp_path / "target.png"), cv2.IMREAD_GRAYSCALE)
    assert drawn is not None and drawn.shape == (1400, 1600)
    target = SquareBoard(TargetKind.charuco, (6, 5), 0.03, 0.0225, "5X5_100")
    found = target.find(np.asarray(cv2.resize(drawn, None, fx=0.3, fy=0.3, interpolation=cv2.INTER_AREA), np.uint8))
    assert found is not None and len(found.ids) == 20
