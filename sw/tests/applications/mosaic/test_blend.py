# SPDX-License-Identifier: Apache-2.0
"""Blending of many frames: by blocks as at once, the lamp's cone taken out, a sketch of what has come so far."""

import numpy as np

from signum.applications.mosaic.blend import compose, sketch
from signum.common.arrays import Image
from signum.geometry.similarity import Similarity
from signum.world.seafloor import photograph

SIZE = 128, 96


def _survey(cone: float) -> tuple[list[Image], list[Similarity], Image]:
    """Frames of a photograph, half a frame apart, under a lamp whose light falls by `cone` in the corners."""
    photo = photograph("gravel")
    u, v = np.meshgrid(np.linspace(-1, 1, SIZE[0]), np.linspace(-1, 1, SIZE[1]))
    light = 1 - cone * (u**2 + v**2) / 2
    places = [Similarity.of(shift=(float(x), float(y))) for y in range(0, 6 * 48, 48) for x in range(0, 6 * 64, 64)]
    frames = []
    for place in places:
        x, y = int(place.shift.real), int(place.shift.imag)
        frames.append(np.asarray(photo[y:y + SIZE[1], x:x + SIZE[0]] * light, np.uint8))
    return frames, places, photo


def test_by_blocks_as_at_once() -> None:
    frames, places, photo = _survey(0.0)
    whole, parts = (compose(frames, places, block=block) for block in (4096, 160))
    assert whole.picture.shape == parts.picture.shape == (5 * 48 + 96, 5 * 64 + 128)
    apart = np.abs(whole.picture.astype(int) - parts.picture)
    assert np.percentile(apart, 99) <= 2 and apart.mean() < 0.5
    inside = np.s_[8:-8, 8:-8]
    truth = photo[: whole.picture.shape[0], : whole.picture.shape[1]]
    assert np.corrcoef(whole.picture[inside].ravel(), truth[inside].ravel())[0, 1] > 0.98


def test_the_lamps_cone_is_taken_out() -> None:
    """Brightness of the mosaic, smoothed to half a frame, against the photograph's: no pattern of frames is left."""
    frames, places, photo = _survey(0.7)
    mosaic = compose(frames, places).picture.astype(float)
    truth = photo[: mosaic.shape[0], : mosaic.shape[1]].astype(float)
    blocks = [(mosaic[y:y + 24, x:x + 32].mean() / truth[y:y + 24, x:x + 32].mean())
              for y in range(24, mosaic.shape[0] - 48, 24) for x in range(32, mosaic.shape[1] - 64, 32)]
    raw = [f[:24, :32].mean() / f[36:60, 48:80].mean() for f in frames]
    assert np.mean(raw) < 0.65, "the frames' corners are dark"
    assert np.std(blocks) / np.mean(blocks) < 0.05


def test_a_large_mosaic_is_made_smaller() -> None:
    frames, places, _ = _survey(0.0)
    mosaic = compose(frames, places, most_pixels=20_000)
    assert mosaic.picture.size <= 21_000 and 0.3 < mosaic.scale < 0.45
    shown = sketch([f[::2, ::2].copy() for f in frames], places, SIZE)
    assert shown.shape == (168, 224) and (shown > 0).mean() > 0.95


def test_blend_places_pictures_and_evens_exposure() -> None:
    photo = photograph("gravel")
    left, right = photo[:, :300], np.clip(photo[:, 200:].astype(float) * 0.7, 0, 255).astype(np.uint8)
    mosaic = compose([left, right], [Similarity(), Similarity.of(shift=(200.0, 0.0))])
    assert mosaic.picture.shape == (512, 512) and mosaic.origin == (0.0, 0.0) and mosaic.scale == 1
    inside = mosaic.picture[16:-16, 16:-16].astype(float)
    truth = photo[16:-16, 16:-16].astype(float)
    for part in (slice(0, 170), slice(184, 280), slice(310, 480)):
        assert np.corrcoef(inside[:, part].ravel(), truth[:, part].ravel())[0, 1] > 0.99
    ratio = inside[:, 310:].mean() / inside[:, :170].mean()
    wanted = truth[:, 310:].mean() / truth[:, :170].mean()
    assert ratio / wanted > 0.85, "the darker picture is brought up to the other"
