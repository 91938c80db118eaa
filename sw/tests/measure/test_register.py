# SPDX-License-Identifier: Apache-2.0
"""Registration against known similarities, and refusal where there is nothing to find."""

from dataclasses import replace
from itertools import pairwise

import cv2
import numpy as np
import pytest
import skimage.data

from signum.applications.mosaic.simulate import Plan, simulate_survey
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Image
from signum.frames.fit import Fit
from signum.geometry.similarity import Similarity, overlap
from signum.measure.measurer import Measurer
from signum.measure.register import Registrar
from signum.measure.registration import Rival
from signum.reproduce.reference import SHARED
from signum.sources.open import open_source
from signum.world.seafloor import photograph
from signum.world.water import COASTAL, Water

SIZE = 384, 288


def _registrar(size: tuple[int, int] = SIZE, window: int = 64, sigma: float = 2.5) -> Registrar:
    board = GoldenBoard()
    return Registrar.on(lambda s, wide: Measurer(board, s, wide), Fit.to(size, board.config, window), window, sigma)


def _cut(photo: Image, place: Similarity, size: tuple[int, int] = SIZE, seed: int = 0) -> Image:
    """The frame that `place` puts into the photograph, with sensor noise."""
    view = cv2.warpAffine(photo, place.matrix, size, flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP)
    noise = np.random.default_rng(seed).normal(0, 3, view.shape)
    return np.asarray(np.clip(view + noise, 0, 255), np.uint8)


@pytest.mark.parametrize(("rot", "scale", "shift"), [
    (0.0, 1.0, (0.0, 96.4)), (0.0, 1.0, (-5.3, -188.0)), (2.0, 1.0, (130.2, 20.0)), (-5.0, 1.03, (20.0, 90.0)),
    (9.0, 0.96, (-60.0, 70.0)), (-8.0, 1.0, (150.0, -30.0)),
])
def test_known_similarity(rot: float, scale: float, shift: tuple[float, float]) -> None:
    photo = photograph("gravel", 2.0)
    registrar = _registrar()
    a = Similarity.of(shift=(320.0, 360.0))
    about = complex(*registrar.centre)
    turn = Similarity.of(rot, scale)
    b = a @ Similarity(turn.factor, about - turn.factor * about + complex(*shift))
    truth = b.inverse @ a
    result = registrar.register(registrar.prepare(_cut(photo, a)), registrar.prepare(_cut(photo, b, seed=1)))
    assert result.accepted, result.reason
    corners = np.array([[0.0, 0.0], [383.0, 0.0], [0.0, 287.0], [383.0, 287.0], [191.5, 143.5]])
    assert np.abs(result.similarity(corners) - truth(corners)).max() < 1.5
    wanted = truth(registrar.centre) - registrar.centre
    assert np.allclose(result.shift, wanted, atol=0.6)
    assert result.turning and result.score > 0.7 and result.agreed >= 4


def test_pictures_larger_than_the_board_answer_in_their_own_pixels() -> None:
    photo = photograph("gravel", 4.0)
    registrar = _registrar((1280, 960))
    assert registrar.fine.board == (640, 480)
    a, b = Similarity.of(shift=(300.0, 600.0)), Similarity.of(shift=(337.0, 281.0))
    result = registrar.register(registrar.prepare(_cut(photo, a, (1280, 960))),
                                registrar.prepare(_cut(photo, b, (1280, 960), 1)))
    assert result.accepted and np.allclose(result.shift, (-37.0, 319.0), atol=1.0)


@pytest.mark.parametrize("other", ["grass", "brick", "moon", "elsewhere", "flat"])
def test_strangers_are_refused(other: str) -> None:
    photo = photograph("gravel", 2.0)
    if other == "flat":
        stranger = np.full((1024, 1024), 90, np.uint8)
    elif other == "elsewhere":
        stranger = np.ascontiguousarray(photo[::-1])
    else:
        stranger = np.asarray(cv2.resize(getattr(skimage.data, other)(), (1024, 1024)), np.uint8)
    registrar = _registrar()
    place = Similarity.of(shift=(320.0, 360.0))
    result = registrar.register(registrar.prepare(_cut(photo, place)), registrar.prepare(_cut(stranger, place, seed=1)))
    assert not result.accepted and result.reason


@pytest.mark.parametrize(("water", "seed", "a", "b"), [
    (Water(noise=2.0), 2, 27, 29), (Water(noise=2.0), 4, 1, 9), (Water(noise=2.0), 9, 2, 84), (COASTAL, 7, 15, 86),
])
def test_pairs_without_overlap_on_which_windows_agree_are_refused(water: Water, seed: int, a: int, b: int) -> None:
    """Tilted views of relief, with nothing in common: a quarter to a half of the windows share a motion by chance."""
    plan = Plan(10, 10, relief=0.12, tilt_deg=3.0, water=water)
    flown = simulate_survey(plan, seed)
    cells = flown.sequence()
    registrar = _registrar(plan.size, 48, 2.0)
    assert overlap(flown.truth[cells[b]].inverse @ flown.truth[cells[a]], plan.size) == 0
    found = registrar.register(registrar.prepare(flown.frames[cells[a]]), registrar.prepare(flown.frames[cells[b]]))
    assert found.agreed >= 6 and not found.accepted, found
    assert found.evidence < registrar.limits.evidence and "small windows" in found.reason


def test_a_doubtful_registration_of_which_no_small_window_is_found_again_is_refused() -> None:
    photo = photograph("gravel", 2.0)
    registrar = _registrar()
    place = Similarity.of(shift=(320.0, 360.0))
    a, flat = registrar.prepare(_cut(photo, place)), registrar.prepare(np.full(SIZE[::-1], 90, np.uint8))
    sure = registrar.register(a, a)
    doubtful = replace(sure, evidence=3.2)
    assert registrar._closer(a, flat, sure).accepted and not registrar._closer(a, flat, doubtful).accepted
    rival = Rival(sure.similarity, 0.8, 0.1, 6, True, sure.middle, 20.0, 0.5, 4.0)
    assert registrar._closer(a, a, doubtful).evidence > 3.2
    assert registrar._closer(a, a, replace(doubtful, rivals=(rival,))).evidence == 3.2


@pytest.mark.parametrize("run", ["skerki", "imos/test1", "imos/test5"])
def test_mirrored_neighbours_of_real_surveys_are_refused(run: str) -> None:
    if not (SHARED / run).exists():
        pytest.skip(f"no {SHARED / run} on this machine")
    frames = [frame.picture for frame in open_source(SHARED / run)]
    registrar = _registrar((frames[0].shape[1], frames[0].shape[0]))
    proof = []
    for a, b in pairwise(frames):
        found = registrar.register(registrar.prepare(a), registrar.prepare(np.ascontiguousarray(b[:, ::-1])))
        proof.append(found.evidence)
        assert not found.accepted, proof
    print(f"{run}: evidence for {len(proof)} wrong pairs at most {max(proof):.1f} decades")
    assert len(proof) >= 7 and max(proof) <= 0.5 * registrar.limits.evidence


def test_a_guess_saves_the_search_and_a_wrong_one_is_refused() -> None:
    photo = photograph("gravel", 2.0)
    registrar = _registrar()
    a, b = Similarity.of(shift=(300.0, 300.0)), Similarity.of(shift=(306.0, 280.0))
    pictures = registrar.prepare(_cut(photo, a)), registrar.prepare(_cut(photo, b, seed=1))
    near = registrar.register(*pictures, guess=Similarity.of(shift=(0.0, 10.0)), reach=16)
    assert near.accepted and np.allclose(near.shift, (-6.0, 20.0), atol=0.3)
    far = registrar.register(*pictures, guess=Similarity.of(shift=(0.0, 90.0)), reach=16)
    assert not far.accepted
