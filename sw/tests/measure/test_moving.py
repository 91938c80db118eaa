# SPDX-License-Identifier: Apache-2.0
"""What moves by itself, pixel by pixel: a sample of `make moving-bars`, two things at once, what is fixed to the
camera, and what cannot be told."""

from __future__ import annotations

import numpy as np
import pytest

from golden.params import DENSE
from signum.boards.board import BoardError
from signum.boards.golden import GoldenBoard
from signum.geometry.similarity import Similarity
from signum.measure.background import find_background
from signum.measure.flow import FlowField
from signum.measure.measurer import Measurer
from signum.measure.motions import Residuals, find_motions
from signum.measure.moving import segment_moving
from signum.report.outlines import draw_outlines, mask_picture
from tests.dense_bars import picture
from tests.measure.movers import SIZE, large_photo, moving_figures, scene, segmented

X, Y = np.arange(17.0, 384, 8), np.arange(17.0, 304, 8)


@pytest.mark.parametrize("murky", [False, True])
@pytest.mark.parametrize(("side", "first"), [(96, 60), (160, 64)])
def test_a_thing_that_moves_by_itself(side: int, first: int, murky: bool) -> None:
    for seed in range(first, first + 3):
        seen = scene(seed, side, murky)
        figures = moving_figures(seen)
        print(f"{seen.label}: {figures}")
        assert figures.overlap >= 0.7 and figures.off_px <= 1 and not figures.false
        assert figures.edge_px <= (16 if murky else 8), "half a window, a whole one in figure 8"


@pytest.mark.parametrize("murky", [False, True])
def test_nothing_where_nothing_moves_by_itself(murky: bool) -> None:
    for seed in range(70, 74):
        seen = scene(seed, None, murky)
        assert segmented(seen.before, seen.after).objects == (), seen.label


def test_something_of_half_the_size_that_the_field_leaves_out() -> None:
    figures = moving_figures(scene(80, 56))
    print(figures)
    assert figures.overlap >= 0.7 and figures.off_px <= 0.5 and not figures.false


def test_two_things_have_their_own_numbers_boxes_and_motions() -> None:
    before = picture("gravel")[:320, :400].copy()
    after = np.roll(before, (2, -3), (0, 1))
    for name, (width, height, left, top), (dx, dy) in zip(("coffee", "grass"), (
            (112, 90, 40, 60), (96, 80, 250, 190)), ((4, -5), (-3, 9)), strict=True):
        thing = picture(name)[100:100 + height, 180:180 + width]
        for frame, x, y in ((before, left, top), (after, left + dx, top + dy)):
            frame[y:y + height, x:x + width] = thing
    found = segmented(before, after)
    assert len(found.objects) == 2 and found.background is not None and found.background.share > 0.7
    wanted = (96, 105, 112, 90, 4, -5), (298, 230, 96, 80, -3, 9)
    for n, (one, (x, y, width, height, dx, dy)) in enumerate(zip(found.objects, wanted, strict=True), 1):
        assert (one.x, one.y) == pytest.approx((x, y), abs=5)
        assert (one.width, one.height) == pytest.approx((width, height), abs=16)
        assert (one.dx, one.dy) == pytest.approx((dx, dy), abs=0.2)
        assert (one.own_dx, one.own_dy) == pytest.approx((dx + 3, dy - 2), abs=0.2)
        rows, columns = np.nonzero(found.labels == n)
        assert one.area == rows.size and (one.left, one.top) == (columns.min(), rows.min())
        assert one.confidence > 80 and one.score > 0.85 and one.margin > 0.25
    shown = mask_picture(found)
    assert set(np.unique(shown)) == {0, 254, 255} and ((shown == 255) == (found.labels == 1)).all()
    drawn = draw_outlines(before, found)
    assert drawn.shape == (320, 400, 3) and (drawn != before[..., None]).any(-1).mean() < 0.1


def test_steps_of_light_that_are_fixed_to_the_camera_are_no_object() -> None:
    """Where the picture is plain, all that figure 8 leaves are the steps of its light, which does not move."""
    dark = np.full(SIZE[::-1], 20, np.uint8)
    for photo in ("gravel", "astronaut"):
        seen = scene(211, None, True, photo)
        assert segmented(seen.before, seen.after).objects == (), photo
    assert segmented(dark, dark).objects == ()


def test_a_near_thing_at_rest_counts_when_the_camera_moves() -> None:
    """Parallax: two pictures cannot tell a high stone from something that moves, and it is said so."""
    floor, stone = large_photo("gravel"), large_photo("grass")[:110, :110]
    before, after = floor[:320, 20:420].copy(), floor[:320, 14:414].copy()  # the floor moves by 6 pixels
    before[100:210, 140:250], after[100:210, 150:260] = stone, stone  # the stone, nearer to the camera, by 10
    found = segmented(before, after)
    assert [round(one.own_dx) for one in found.objects] == [4]


def test_no_common_motion_no_object() -> None:
    gravel, grass = (picture(name)[:200, :240].copy() for name in ("gravel", "grass"))
    found = segmented(gravel, grass)
    assert found.background is None and found.objects == () and not found.labels.any()


def test_a_board_without_the_engine_is_refused() -> None:
    measurer = Measurer(GoldenBoard(), (96, 72), 1.5)
    views = measurer.pair(*(np.zeros((72, 96), np.uint8),) * 2)
    with pytest.raises(BoardError, match="no dense engine"):
        segment_moving(measurer, *views, _field(Similarity()))
    assert measurer.free_views == 4, "no view is left on the board"


def test_a_full_board_is_said() -> None:
    measurer = Measurer(GoldenBoard(DENSE), (96, 72), 1.5)
    views = [measurer.view(np.zeros((72, 96), np.uint8)) for _ in range(3)]
    with pytest.raises(RuntimeError, match="release one first"):
        segment_moving(measurer, views[0], views[1], _field(Similarity()))


def _field(motion: Similarity, noise: float = 0.0) -> FlowField:
    """Flow of a picture that moves as a whole, with noise in both components, pixels."""
    at = np.stack(np.meshgrid(X, Y), -1)
    moved = motion(at) - at + np.random.default_rng(3).normal(0, noise, at.shape)
    return FlowField(X, Y, moved[..., 0], moved[..., 1], np.ones(at.shape[:2]))


def test_the_background_is_what_most_of_the_field_has() -> None:
    motion = Similarity.of(1.5, 0.98, (3.0, -7.0))
    field = _field(motion, 0.1)
    field.dx[5:20, 10:30] += 5
    found = find_background(field)
    corners = np.array([[0.0, 0], [399, 319]])
    assert found is not None and found(corners) == pytest.approx(motion(corners), abs=0.15)
    assert found.share == pytest.approx(1 - 15 * 20 / field.dx.size, abs=0.03)
    assert found.noise_px == pytest.approx(0.1, rel=0.15)


def test_too_small_a_part_of_the_view_is_no_background() -> None:
    few, corner, torn = (_field(Similarity.of(1.0)) for _ in range(3))
    few.dx[:, :-1] = few.dx[11:] = np.nan
    corner.dx[15:] = corner.dx[:, 20:] = np.nan
    torn.dx[:] = np.random.default_rng(1).uniform(-16, 16, torn.dx.shape)
    assert find_background(few) is None and find_background(corner) is None and find_background(torn) is None


def test_groups_of_windows_give_motions_and_strays_none() -> None:
    y, x = np.mgrid[8:300:8, 8:380:8]
    at = np.stack([x, y], -1)
    rng = np.random.default_rng(5)
    moved, turned = rng.uniform(-16, 16, at.shape), Similarity.of(2.0, 1.0, (4.0, -3.0))
    moved[5:20, 4:20] = (turned(at.astype(float)) - at)[5:20, 4:20]
    moved[24:32, 30:40] = -6, 2
    windows = Residuals(at, moved, np.ones(x.shape, bool))
    first, second = find_motions(windows, 40, 1.0, 6)
    assert (first.rot_deg, first.scale) == pytest.approx((2, 1), abs=0.1) and abs(first.shift - (4 - 3j)) < 0.2
    assert (second.shift.real, second.shift.imag) == pytest.approx((-6, 2), abs=0.5)
    assert find_motions(windows, 40, 1.0, 1) == [first]
    assert find_motions(windows, 40, 1.0, 6, known=[first]) == [second]
    assert find_motions(Residuals(at, moved, np.zeros(x.shape, bool)), 1, 1.0, 6) == []
