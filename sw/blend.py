"""One picture from many: frames warped into the mosaic plane, exposure evened out, seams found, bands blended."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sw.geometry import Similarity
from sw.sources import Picture

MOST_PIXELS = 60_000_000
"""Of a mosaic; a larger one is made at a smaller scale."""
SEAM_PIXELS = 100_000
"""Size to which frames are scaled to look for seams."""
BANDS = 4
RIM = 2
"""Pixels left out along the frames' edges, where cameras and scanners leave marks."""


@dataclass(frozen=True)
class Mosaic:
    """A mosaic.

    Attributes:
        picture: uint8 (H, W) or (H, W, 3), black where no frame is.
        origin: position of its pixel (0, 0) in the mosaic plane, pixels.
        scale: its pixels per pixel of the mosaic plane; 1 unless the mosaic would have been too large.
    """

    picture: Picture
    origin: tuple[float, float]
    scale: float


def compose(pictures: Sequence[Picture], places: Sequence[Similarity]) -> Mosaic:
    """Blend pictures.

    Args:
        pictures: uint8 (H, W) or (H, W, 3), at least one; grey and colour may be mixed.
        places: pixels of each picture -> mosaic plane.
    """
    corners = [place(_corners(picture)) for picture, place in zip(pictures, places, strict=True)]
    low, high = np.floor(np.min(np.vstack(corners), axis=0)), np.ceil(np.max(np.vstack(corners), axis=0))
    extent = high - low + 1
    scale = min(1.0, float(np.sqrt(MOST_PIXELS / (extent[0] * extent[1]))))
    view = Similarity(complex(scale), -scale * complex(low[0], low[1]))
    grey = all(p.ndim == 2 for p in pictures)
    tiles, masks, spots = [], [], []
    for picture, place in zip(pictures, places, strict=True):
        tile, mask, spot = _tile(picture, view @ place)
        tiles.append(tile)
        masks.append(mask)
        spots.append(spot)
    if len(tiles) > 1:
        masks = _match(spots, tiles, masks)
    size = tuple(int(v) for v in np.ceil(extent * scale))
    blender = cv2.detail.MultiBandBlender()
    blender.setNumBands(BANDS)
    blender.prepare((0, 0, size[0] + 1, size[1] + 1))
    for tile, mask, spot in zip(tiles, masks, spots, strict=True):
        blender.feed(tile.astype(np.int16), mask, spot)
    blended, covered = blender.blend(np.empty(0, np.int16), np.empty(0, np.uint8))
    out = np.clip(blended, 0, 255).astype(np.uint8)
    out[np.asarray(covered) == 0] = 0
    out = out[: size[1], : size[0]]
    return Mosaic(np.ascontiguousarray(out[:, :, 0] if grey else out), (float(low[0]), float(low[1])), scale)


def _corners(picture: Picture) -> NDArray[np.float64]:
    height, width = picture.shape[:2]
    return np.array([[0, 0], [width - 1, 0], [0, height - 1], [width - 1, height - 1]], np.float64)


def _tile(picture: Picture, place: Similarity) -> tuple[Picture, Picture, tuple[int, int]]:
    """The picture warped, in colour, with its mask and the mosaic pixel of its corner."""
    colour = picture if picture.ndim == 3 else cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR)
    corners = place(_corners(picture))
    low = np.maximum(np.floor(corners.min(axis=0)), 0).astype(int)
    size = [int(v) for v in np.ceil(corners.max(axis=0)).astype(int) - low + 1]
    matrix = place.matrix - np.array([[0, 0, low[0]], [0, 0, low[1]]])
    tile = cv2.warpAffine(colour, matrix, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    whole = np.zeros(picture.shape[:2], np.uint8)
    whole[RIM:-RIM, RIM:-RIM] = 255
    mask = cv2.warpAffine(whole, matrix, size, flags=cv2.INTER_NEAREST)
    return np.asarray(tile, np.uint8), np.asarray(mask, np.uint8), (int(low[0]), int(low[1]))


def _match(spots: list[tuple[int, int]], tiles: list[Picture], masks: list[Picture]) -> list[Picture]:
    """Even out the exposure of the tiles, in place, and cut their masks along seams where they differ least.

    Both are worked out at a smaller scale. The gains are one number a picture, for exposure, then smooth maps, for the
    light cone.
    """
    shrink = min(1.0, float(np.sqrt(SEAM_PIXELS / max(t.shape[0] * t.shape[1] for t in tiles))))
    at = [(round(x * shrink), round(y * shrink)) for x, y in spots]
    sizes = [(max(1, round(t.shape[1] * shrink)), max(1, round(t.shape[0] * shrink))) for t in tiles]
    small = [cv2.resize(t, s, interpolation=cv2.INTER_AREA) for t, s in zip(tiles, sizes, strict=True)]
    cut = [cv2.resize(m, s, interpolation=cv2.INTER_NEAREST) for m, s in zip(masks, sizes, strict=True)]
    for kind in (cv2.detail.EXPOSURE_COMPENSATOR_GAIN, cv2.detail.EXPOSURE_COMPENSATOR_GAIN_BLOCKS):
        compensator = cv2.detail.ExposureCompensator.createDefault(kind)
        compensator.feed(at, [_umat(t) for t in small], [_umat(m) for m in cut])
        for i, (tile, mask) in enumerate(zip(tiles, masks, strict=True)):
            small[i] = compensator.apply(i, at[i], small[i], cut[i])
            tiles[i] = np.asarray(compensator.apply(i, spots[i], tile, mask), np.uint8)
    finder = cv2.detail.DpSeamFinder("COLOR_GRAD")
    seams = finder.find([_umat(t.astype(np.float32)) for t in small], at, [_umat(m) for m in cut])
    out = []
    for seam, mask in zip(seams, masks, strict=True):
        grown = cv2.dilate(seam.get(), np.ones((3, 3), np.uint8))
        wide = np.asarray(cv2.resize(grown, mask.shape[::-1], interpolation=cv2.INTER_LINEAR))
        out.append(np.where(wide > 127, mask, 0).astype(np.uint8))
    return out


def _umat(image: NDArray[np.generic]) -> cv2.UMat:
    make: Callable[..., cv2.UMat] = cv2.UMat  # OpenCV's type stubs leave out the constructor from an array
    return make(np.ascontiguousarray(image))
