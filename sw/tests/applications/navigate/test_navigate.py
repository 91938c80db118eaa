# SPDX-License-Identifier: Apache-2.0
"""Mosaic navigation against the truth of the simulated world, and on a mosaic of a photograph."""

from __future__ import annotations

import csv
from itertools import combinations
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

from signum.applications.navigate.aim import Aim, TargetFinder
from signum.applications.navigate.chart import Chart, ChartError
from signum.applications.navigate.conformal import Conformal
from signum.applications.navigate.localise import Localiser
from signum.applications.navigate.place import ANY_HEADING, LocaliseLimits, Place
from signum.applications.navigate.simulate.pan_tilt import PanTiltScene, PanTiltSite
from signum.applications.navigate.steering import PanTiltSteering, VehicleSteering
from signum.boards.golden import GoldenBoard
from signum.commands.cli import application
from signum.common.files import write_picture
from signum.frames.fit import Fit
from signum.geometry.similarity import Similarity
from signum.measure.measurer import Measurer
from signum.world.seafloor import photograph
from tests.localising import judge

app = application()

SIZE = (256, 192)
LARGEST = (640, 480)


@pytest.fixture(scope="module")
def floor() -> NDArray[np.uint8]:
    """A photograph enlarged: a quilt of it would show parts of it several times."""
    photo = cv2.resize(photograph("gravel").astype(np.float32), (900, 900), interpolation=cv2.INTER_CUBIC)
    return np.asarray(np.clip(photo[:700], 1, 255), np.uint8)


def _localiser(chart: Chart, limits: LocaliseLimits | None = None, size: tuple[int, int] = SIZE) -> Localiser:
    board = GoldenBoard()
    return Localiser(lambda s, sigma: Measurer(board, s, sigma), LARGEST, Fit.to(size, board.config, 48), chart, 48,
                     limits=limits)


def _frame(floor: NDArray[np.uint8], place: Similarity, seed: int = 0) -> NDArray[np.uint8]:
    """What a camera at `place` (frame -> floor) sees: dimmer, noisy."""
    seen = cv2.warpAffine(floor, place.matrix, SIZE, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP).astype(np.float64)
    noise = np.random.default_rng(seed).normal(0, 4, seen.shape)
    return np.asarray(np.clip(0.6 * seen + 20 + noise, 0, 255), np.uint8)


def _place(x: float, y: float, rot_deg: float = 0.0, scale: float = 1.0) -> Similarity:
    """A frame whose centre is at (x, y)."""
    turn = Similarity.of(rot_deg, scale)
    return Similarity(turn.factor, complex(x, y) - turn.factor * complex((SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2))


@pytest.mark.parametrize(("x", "y", "rot", "scale"), [(200, 200, 0, 1), (700, 500, 5, 1.05), (450, 350, -10, 0.95)])
def test_found_anywhere(floor: NDArray[np.uint8], x: float, y: float, rot: float, scale: float) -> None:
    found = _localiser(Chart.of(floor)).locate(_frame(floor, _place(x, y, rot, scale)))
    assert found.similarity is not None and found.confidence > 50
    assert found.centre == pytest.approx((x, y), abs=1.0)
    assert found.similarity.rot_deg == pytest.approx(rot, abs=0.5)
    assert found.similarity.scale == pytest.approx(scale, abs=0.01)


def test_any_heading(floor: NDArray[np.uint8]) -> None:
    frame = _frame(floor, _place(500, 400, 31))
    assert not _localiser(Chart.of(floor)).locate(frame).known, "not looked for turned so far"
    found = _localiser(Chart.of(floor), LocaliseLimits(turns_deg=ANY_HEADING)).locate(frame)
    assert found.similarity is not None and found.centre == pytest.approx((500, 400), abs=1.0)
    assert found.similarity.rot_deg == pytest.approx(31, abs=0.5)


def test_with_a_prior_and_with_a_wrong_one(floor: NDArray[np.uint8]) -> None:
    localiser, frame = _localiser(Chart.of(floor)), _frame(floor, _place(430, 300, 3))
    near = localiser.locate(frame, _place(420, 308))
    assert near.known and near.centre == pytest.approx((430, 300), abs=1.0)
    far = localiser.locate(frame, _place(600, 300))
    assert not far.known and far.confidence == 0 and np.isnan(far.centre).all() and "windows agree" in far.reason


def test_nothing_is_found_that_is_not_there(floor: NDArray[np.uint8]) -> None:
    localiser = _localiser(Chart.of(floor))
    strange = cv2.resize(photograph("grass").astype(np.float32), (900, 900)).astype(np.uint8)
    for frame in (strange[:SIZE[1], :SIZE[0]], np.full(SIZE[::-1], 90, np.uint8)):
        assert not localiser.locate(np.ascontiguousarray(frame)).known


def test_views_in_murk_are_found() -> None:
    """A sample of `make navigate-bars`, whose bar is that of all floors together: bricks in figure 8's murk, grass that
    shows parts of itself several times."""
    counts = np.array([judge(name, 3, views, murky=True)[:2] for name, views in (("brick", 8), ("grass", 8))])
    right, wrong = counts.sum(axis=0)
    assert wrong == 0 and right >= 0.75 * 16, counts


def test_two_places_that_look_alike_are_none(floor: NDArray[np.uint8]) -> None:
    twice = np.hstack([floor[:400, :420], floor[:400, :420]])
    place = _localiser(Chart.of(twice)).locate(_frame(floor, _place(200, 200)))
    assert not place.known and place.reason == "two places match"


def test_a_torn_mosaic_is_believed_only_away_from_the_tear(floor: NDArray[np.uint8]) -> None:
    torn = floor.copy()
    torn[271:, 431:] = floor[::-1][271:, 431:]
    localiser = _localiser(Chart.of(torn))
    across = localiser.locate(_frame(floor, _place(475, 300)))
    assert not across.known and across.agreed >= 8
    assert across.reason == "the mosaic does not match around the frame's middle"
    beside = localiser.locate(_frame(floor, _place(400, 300)))
    assert beside.known and beside.centre == pytest.approx((400, 300), abs=1.0)


def test_beside_the_border(floor: NDArray[np.uint8]) -> None:
    """A third of the view off the mosaic: found by the rest."""
    cut = floor.copy()
    cut[:, :300] = 0
    found = _localiser(Chart.of(cut)).locate(_frame(floor, _place(345, 300)))
    assert found.known and found.centre == pytest.approx((345, 300), abs=1.0)


def test_frames_larger_than_the_board(floor: NDArray[np.uint8]) -> None:
    wide = np.asarray(cv2.resize(floor, None, fx=3.0, fy=3.0, interpolation=cv2.INTER_CUBIC), np.uint8)
    frame = np.ascontiguousarray(wide[600:600 + 720, 900:900 + 960])
    found = _localiser(Chart.of(wide), size=(960, 720)).locate(frame)
    assert found.known and found.centre == pytest.approx((900 + 479.5, 600 + 359.5), abs=2.0)


def test_looking_at_a_place_closes_in_on_it(floor: NDArray[np.uint8]) -> None:
    """The steering over a flat mosaic: no overshoot beyond a tenth, and to within a pixel; then it is kidnapped."""
    focal, dt = 300.0, 0.1
    at, target = np.array([480.0, 420.0]), (610.0, 340.0)
    finder, steering = TargetFinder(_localiser(Chart.of(floor)), target), PanTiltSteering(focal)
    errors = []
    for k in range(46):
        if k == 24:
            at += (-90.0, 80.0)
        aim = finder.look(_frame(floor, _place(*at), seed=k))
        pan, tilt = steering.rates(aim, dt)
        at = at + np.array([pan, -tilt]) * focal * dt
        errors.append(float(np.hypot(*(at - target))))
    assert errors[23] < 1.0
    assert errors[25] > 80 and errors[-1] < 1.0, "lost, found, and back"


@pytest.mark.parametrize(("error", "place", "axis", "sign"), [
    ((30.0, 0.0), Similarity(), 1, 1), ((0.0, -30.0), Similarity(), 0, 1),
    ((0.0, 0.0), Similarity.of(scale=1.05), 2, 1), ((0.0, 0.0), Similarity.of(rot_deg=4.0), 5, -1)])
def test_the_vehicle_is_pushed_the_right_way(error: tuple[float, float], place: Similarity, axis: int, sign: int
                                             ) -> None:
    """Right of the middle, ahead, too high, turned to the right: force to the right, ahead, down, turn to the left."""
    steering = VehicleSteering(focal=400.0, range_m=2.0)
    aim = Aim(Place(place, (0.0, 0.0), 0.9, 90), np.array(error), True)
    for _ in range(3):
        forces = steering.forces(aim, (0.0, 0.0), 0.1)
    assert sign * forces[axis] > 0.5 and np.delete(forces, axis) == pytest.approx(np.zeros(5), abs=1e-6)
    tilted = VehicleSteering(focal=400.0, range_m=2.0).forces(
        Aim(Place(Similarity(), (0.0, 0.0), 0.9, 90), np.array([0.0, -400 * np.tan(0.05)]), True), (0.0, -0.05), 0.1)
    assert tilted == pytest.approx(np.zeros(6), abs=1e-6), "nose down by as much: it is right above"


def test_conformal_pictures() -> None:
    lens = Conformal((384, 288), 400.0)
    corners = lens.pinhole(np.array([[0, 0], [lens.shown[0] - 1, lens.shown[1] - 1]], np.float64))
    assert (corners >= 0).all() and (corners <= [383, 287]).all()
    centre = (np.array(lens.shown) - 1) / 2
    assert lens.pinhole(centre) == pytest.approx([191.5, 143.5])
    theta = 0.3
    seen = lens.pinhole(centre + np.array([800 * np.tan(theta / 2), 0]))
    assert seen[0] - 191.5 == pytest.approx(400 * np.tan(theta))


def test_places_by_name_and_pixel(floor: NDArray[np.uint8], tmp_path: Path) -> None:
    write_picture(tmp_path / "mosaic.png", floor)
    (tmp_path / "places.csv").write_text("name,x_px,y_px\nanchor,120,80\n")
    chart = Chart.load(tmp_path)
    assert chart.place("anchor") == (120.0, 80.0) and chart.place("10,20.5") == (10.0, 20.5)
    for text, says in (("wreck", "one of anchor"), ("9000,3", "not on the mosaic")):
        with pytest.raises(ChartError, match=says):
            chart.place(text)
    with pytest.raises(ChartError, match="no such mosaic"):
        Chart.load(tmp_path / "none")


def test_the_command(floor: NDArray[np.uint8], tmp_path: Path) -> None:
    for folder in ("mosaic", "dive"):
        (tmp_path / folder).mkdir()
    write_picture(tmp_path / "mosaic" / "mosaic.png", floor)
    way = [(150.0, 150.0), (160.0, 158.0), (170.0, 166.0), (640.0, 480.0)]
    for k, (x, y) in enumerate(way):
        write_picture(tmp_path / "dive" / f"{k}.png", _frame(floor, _place(x, y), k))
    write_picture(tmp_path / "dive" / "4.png", np.full(SIZE[::-1], 50, np.uint8))
    result = CliRunner().invoke(app, ["navigate", str(tmp_path / "mosaic"), str(tmp_path / "dive"), "--window", "48",
                                      "--goto", "300,200", "--out", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    assert "4 of 5 frames found" in result.stdout
    with (tmp_path / "out" / "navigate.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["frame", "time_s", "x_px", "y_px", "rot_deg", "scale", "score", "confidence"]
    for row, (x, y) in zip(rows, way, strict=False):
        assert (float(row["x_px"]), float(row["y_px"])) == pytest.approx((x, y), abs=1.5)
    assert rows[4]["x_px"] == "" and rows[4]["confidence"] == "0"
    with (tmp_path / "out" / "goto.csv").open() as file:
        aims = list(csv.DictReader(file))
    assert (float(aims[0]["right_px"]), float(aims[0]["down_px"])) == pytest.approx((150, 50), abs=1.5)
    page = (tmp_path / "out" / "report.html").read_text()
    assert "Mosaic navigation" in page and page.count("data:image/png") >= 2


def test_a_pan_tilts_mosaic_is_bent_and_not_torn(tmp_path: Path) -> None:
    """Neighbours of a sweep lie where they belong, though no loop on a sphere closes in the plane."""
    site = PanTiltSite(PanTiltScene(photo="brick"))
    board = GoldenBoard()
    site.survey(lambda s, sigma: Measurer(board, s, sigma), tmp_path)
    middle = (np.array(site.size) - 1) / 2
    misses = []
    for (pa, a), (pb, b) in combinations(site.truth.shots, 2):
        way = pa.inverse(pb(middle)) - middle
        if (np.abs(way) > 0.75 * np.array(site.size)).any():
            continue
        at = middle + way / 2
        x, y = site.redrawn.pinhole(at)
        ray = np.array([*((np.array([x, y]) - site.camera.centre) / site.camera.focal), 1.0])
        point = a.sight.position + a.sight.rotation @ (float(a.depth[round(y), round(x)]) * ray)
        misses.append(np.hypot(*(site.redrawn.pinhole(pb.inverse(pa(at))) - site.camera.project(b.sight, point)[0])))
    assert len(misses) > 250 and max(misses) < 12 and np.median(misses) < 2
