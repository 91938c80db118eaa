# SPDX-License-Identifier: Apache-2.0
"""What a mosaic looks like: evenly bright over the whole survey, without fish, as sharp as a frame; colour in water."""

import cv2
import numpy as np
import pytest

from signum.applications.mosaic.blend import Composition, compose
from signum.applications.mosaic.photometry import LEAST, MOST, fit_light, shrink
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity
from tests.applications.mosaic.survey_with_fish import Lit, judge_looks, lit_survey


@pytest.mark.parametrize("seed", [101, 102])
def test_even_without_fish_and_sharp(seed: int) -> None:
    survey = lit_survey(seed, rows=4, columns=5)
    mosaic = compose(survey.frames, survey.places)
    looks = judge_looks(survey, mosaic.picture, mosaic.origin)
    print(f"seed {seed}: {looks}")
    assert looks.slope <= 0.03 and looks.uneven <= 0.04, "the frames' exposure changes by 80 % over the survey"
    assert looks.fish <= 0.08
    assert 0.95 <= looks.sharp <= 1.08, "against the floor, which each frame shows as sharp as it is"


def _contrast(survey: Lit, picture: Floats, corner: tuple[float, float]) -> float:
    """Logarithm of the brightness of the patch of sand over that around it."""
    v, u = np.mgrid[:picture.shape[0], :picture.shape[1]]
    away = np.hypot(u + corner[0] - survey.floor.shape[1] / 2, v + corner[1] - survey.floor.shape[0] / 2)
    return float(np.log(picture[away < 55].mean() / picture[(away > 85) & (away < 130)].mean()))


def test_a_bright_place_of_the_floor_stays() -> None:
    survey = lit_survey(103, rows=4, columns=4, fish=0.0, sand=0.4)
    mosaic = compose(survey.frames, survey.places)
    kept = _contrast(survey, mosaic.picture.astype(np.float64), mosaic.origin) / _contrast(survey, survey.floor, (0, 0))
    print(f"contrast of a patch as large as a frame: {kept:.0%} of the floor's")
    assert 0.85 <= kept <= 1.1


def test_frames_that_turn_dark_or_are_black_are_taken() -> None:
    survey = lit_survey(104, rows=2, columns=2, fish=0.0)
    dark: list[Image] = [np.zeros_like(f) if k == 1 else f for k, f in enumerate(survey.frames)]
    for frames in (dark, [np.zeros_like(f) for f in survey.frames]):
        light = fit_light([shrink(f) for f in frames], [(192, 144)] * 4, survey.places)
        factors = np.stack([light.factor(k, frames[k].shape) for k in range(4)])
        assert np.isfinite(factors).all() and factors.min() >= LEAST and factors.max() <= MOST
        assert compose(frames, survey.places).picture.shape[0] > 200


def test_marine_snow_is_left_out_where_another_frame_shows_the_place() -> None:
    survey, rng = lit_survey(109, rows=3, columns=3, fish=0.0, drift=0.2), np.random.default_rng(109)
    clear = compose(survey.frames, survey.places)
    fallen = np.zeros(survey.floor.shape, np.uint8)
    for frame, place in zip(survey.frames, survey.places, strict=True):
        flakes = np.zeros_like(frame)
        for top, left in zip(rng.integers(0, 141, 50), rng.integers(0, 189, 50), strict=True):
            flakes[top:top + 3, left:left + 3] = 1
        frame[flakes > 0] = 255
        onto = cv2.warpAffine(flakes, place.matrix, fallen.shape[::-1], flags=cv2.INTER_NEAREST)
        fallen |= np.asarray(onto, np.uint8)
    snowy = compose(survey.frames, survey.places)
    x, y = (int(n) for n in snowy.origin)
    here = np.s_[y:y + snowy.picture.shape[0], x:x + snowy.picture.shape[1]]
    several = (survey.seen[here] >= 3) & (fallen[here] > 0)
    left = (cv2.subtract(snowy.picture, clear.picture) > 60)[several].mean()
    print(f"{left:.1%} of the flakes over places that three frames or more show are left")
    assert several.sum() > 400 and left <= 0.12


def _tinted(frames: list[Image]) -> list[Image]:
    """Greenish blue, and dark."""
    return [np.stack([f * 0.5, f * 0.6, f * 0.2], axis=-1).astype(np.uint8) for f in frames]


def test_colour_correction_takes_the_tint_away_where_it_is_asked_for() -> None:
    survey = lit_survey(105, rows=2, columns=2, fish=0.0, drift=0.2, lean=0.1)
    frames = _tinted(survey.frames)
    shown = {}
    for water in (False, True):
        picture = compose(frames, survey.places, water=water).picture
        shown[water] = picture[picture.any(axis=2)].mean(axis=0)
    ratio = shown[False] / shown[False].sum()
    assert ratio == pytest.approx(np.array([0.5, 0.6, 0.2]) / 1.3, abs=0.02), "as it was"
    assert np.ptp(shown[True]) / shown[True].mean() < 0.06
    assert shown[True].mean() > 1.5 * shown[False].mean()


def test_blocks_are_parts_of_the_whole() -> None:
    survey = lit_survey(106, rows=2, columns=2)
    plan = Composition(survey.frames, survey.places)
    whole = compose(survey.frames, survey.places).picture
    part = plan.block((40, 30, 240, 170))
    assert part is not None
    assert np.abs(part.astype(int) - whole[30:170, 40:240]).max() <= 1
    assert plan.block((5000, 5000, 5100, 5100)) is None


def test_frames_of_other_sizes_are_blended() -> None:
    survey = lit_survey(107, rows=2, columns=2, fish=0.0)
    frames = [np.ascontiguousarray(f[:, : 192 - 4 * k]) for k, f in enumerate(survey.frames)]
    mosaic = compose(frames, survey.places)
    assert abs(judge_looks(survey, mosaic.picture, mosaic.origin).slope) < 0.05


def test_a_picture_alone_stays_as_it_is() -> None:
    survey = lit_survey(108, rows=1, columns=1)
    shown = compose(survey.frames, [Similarity()]).picture
    assert np.abs(shown[4:-4, 4:-4].astype(int) - survey.frames[0][4:-4, 4:-4]).max() <= 1
