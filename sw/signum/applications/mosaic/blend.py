# SPDX-License-Identifier: Apache-2.0
"""One picture from many: frames warped into the mosaic plane, exposure evened out, seams found, bands blended.

Pictures are read twice or more, so a sequence that loads them when asked for keeps a large survey's frames out of
memory: exposure and seams are worked out on small copies, and the bands are blended block by block of the mosaic.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity, corners

MOST_PIXELS = 100_000_000
"""Most pixels of a mosaic; a larger one is made at a smaller scale."""
SEAM_PIXELS, ALL_SEAM_PIXELS = 100_000, 24_000_000
"""Most pixels of a frame scaled to find seams, and of all frames together."""
LOCAL_GAINS = 24
"""Most frames whose exposure is compensated in blocks from their overlaps, as the cost grows steeply with the number of
frames. With more frames their mean brightness pattern, the light cone, is divided out instead."""
BLOCK, MARGIN = 4096, 128
"""Side of the blocks blended at a time, and the margin over which the bands extend, pixels of the mosaic."""
BANDS = 4
"""Bands of the blender."""
RIM = 2
"""Pixels left out along the frames' edges, where cameras and scanners leave marks."""

Told = Callable[[str], None]
"""Gets a phrase for each picture that is done, in each part of the work."""
Box = tuple[int, int, int, int]
"""Left, top, right, bottom (exclusive), pixels of the mosaic."""


def silent(phrase: str) -> None:
    """Tells nobody."""


@dataclass(frozen=True)
class Mosaic:
    """A mosaic.

    Attributes:
        picture: uint8 (H, W) or (H, W, 3), black where no frame is.
        origin: position of its pixel (0, 0) in the mosaic plane, pixels.
        scale: its pixels per pixel of the mosaic plane; 1 unless the mosaic would have been too large.
    """

    picture: Image
    origin: tuple[float, float]
    scale: float


def compose(pictures: Sequence[Image], places: Sequence[Similarity], most_pixels: int = MOST_PIXELS,
            block: int = BLOCK, told: Told = silent) -> Mosaic:
    """Blend pictures.

    Args:
        pictures: uint8 (H, W) or (H, W, 3), at least one; grey and colour may be mixed.
        places: pixels of each picture -> mosaic plane.
        most_pixels: of the mosaic.
        block: side of what is blended at a time, pixels.
        told: called as the work goes on.
    """
    sizes, grey = [], True
    for picture in pictures:
        sizes.append((picture.shape[1], picture.shape[0]))
        grey = grey and picture.ndim == 2
    low, high = bounds(sizes, places)
    extent = high - low + 1
    scale = min(1.0, float(np.sqrt(most_pixels / (extent[0] * extent[1]))))
    view = Similarity(complex(scale), -scale * complex(low[0], low[1]))
    matched = _match(pictures, [view @ place for place in places], told)
    width, height = (int(v) for v in np.ceil(extent * scale))
    out = np.zeros((height, width) if grey else (height, width, 3), np.uint8)
    for top in range(0, height, block):
        for left in range(0, width, block):
            box = left, top, min(left + block, width), min(top + block, height)
            part = _blend(pictures, matched, box, told)
            if part is not None:
                out[box[1]:box[3], box[0]:box[2]] = part[:, :, 0] if grey else part
    return Mosaic(out, (float(low[0]), float(low[1])), scale)


def bounds(sizes: Sequence[tuple[int, int]], places: Sequence[Similarity]) -> tuple[Floats, Floats]:
    """Lowest and highest whole position (2,) in the mosaic plane that frames of these (width, height) cover."""
    all_corners = np.vstack([place(corners(size)) for size, place in zip(sizes, places, strict=True)])
    return np.floor(all_corners.min(axis=0)), np.ceil(all_corners.max(axis=0))


def sketch(thumbs: Sequence[Image], places: Sequence[Similarity], size: tuple[int, int],
           most_pixels: int = 1_000_000) -> Image:
    """A quick mosaic of small copies laid over one another, the latest on top: for watching it grow.

    Args:
        thumbs: the pictures, smaller.
        places: pixels of the pictures, at their full `size` (width, height), -> mosaic plane.
        size: of the pictures.
        most_pixels: of the sketch.

    Returns:
        uint8 (H, W) or (H, W, 3).
    """
    low, high = bounds([size] * len(places), places)
    extent = high - low + 1
    small = thumbs[0].shape[1] / size[0]
    scale = min(small, float(np.sqrt(most_pixels / (extent[0] * extent[1]))))
    view = Similarity(complex(scale), -scale * complex(low[0], low[1]))
    canvas = np.zeros((*(max(1, int(v)) for v in np.ceil(extent * scale)[::-1]), *thumbs[0].shape[2:]), np.uint8)
    for thumb, place in zip(thumbs, places, strict=True):
        grow = Similarity(complex(size[0] / thumb.shape[1]))
        tile, mask, (x, y) = _tile(thumb, view @ place @ grow)
        room = canvas[y:y + tile.shape[0], x:x + tile.shape[1]]
        shown = mask[: room.shape[0], : room.shape[1]] > 0
        room[shown] = tile[: room.shape[0], : room.shape[1]][shown]
    return canvas


def _tile(picture: Image, place: Similarity) -> tuple[Image, Image, tuple[int, int]]:
    """The picture warped, with its mask and the mosaic pixel of its corner."""
    framed = place(corners((picture.shape[1], picture.shape[0])))
    low = np.maximum(np.floor(framed.min(axis=0)), 0).astype(int)
    size = [max(1, int(v)) for v in np.ceil(framed.max(axis=0)).astype(int) - low + 1]
    matrix = place.matrix - np.array([[0, 0, low[0]], [0, 0, low[1]]])
    tile = cv2.warpAffine(picture, matrix, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    whole = np.zeros(picture.shape[:2], np.uint8)
    whole[RIM:-RIM, RIM:-RIM] = 255
    mask = cv2.warpAffine(whole, matrix, size, flags=cv2.INTER_NEAREST)
    return np.asarray(tile, np.uint8), np.asarray(mask, np.uint8), (int(low[0]), int(low[1]))


def _coloured(picture: Image) -> Image:
    return picture if picture.ndim == 3 else np.asarray(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR), np.uint8)


@dataclass(frozen=True, eq=False)
class _Matched:
    """How a picture enters the mosaic: its place there, its light, what of it is shown.

    Attributes:
        place: its pixels -> pixels of the mosaic.
        box: where it lies.
        seam: of its tile, at a smaller scale, 255 where it is shown.
        even: evens out the tile's light, (tile, corner, mask) -> tile.
    """

    place: Similarity
    box: Box
    seam: Image
    even: Callable[[Image, tuple[int, int], Image], Image]
    light: NDArray[np.float32] | None

    def tile(self, picture: Image) -> tuple[Image, Image, tuple[int, int]]:
        """The picture as it enters the mosaic: tile, mask, corner."""
        tile, mask, spot = _tile(_lit(_coloured(picture), self.light), self.place)
        tile = self.even(tile, spot, mask)
        wide = cv2.resize(self.seam, mask.shape[::-1], interpolation=cv2.INTER_LINEAR)
        return tile, np.where(np.asarray(wide) > 127, mask, 0).astype(np.uint8), spot


def _match(pictures: Sequence[Image], places: Sequence[Similarity], told: Told) -> list[_Matched]:
    """Even out the exposure of the pictures and find the seams along which they differ least.

    Both are worked out at a smaller scale. The gains are one number a picture, for exposure, then smooth maps, for the
    light cone.
    """
    light = _common_light(pictures) if len(pictures) > LOCAL_GAINS else None
    small, cut, at, boxes = [], [], [], []
    shrink = 1.0
    for index, (picture, place) in enumerate(zip(pictures, places, strict=True)):
        low, high = bounds([(picture.shape[1], picture.shape[0])], [place])
        boxes.append((max(int(low[0]), 0), max(int(low[1]), 0), int(high[0]) + 1, int(high[1]) + 1))
        if index == 0:
            area = picture.shape[0] * picture.shape[1] * place.scale**2
            shrink = min(1.0, float(np.sqrt(min(SEAM_PIXELS, ALL_SEAM_PIXELS / len(places)) / area)))
        less = Similarity(complex(shrink)) @ place
        colour = _lit(_coloured(picture), light)
        if less.scale < 0.7:  # a warp alone would alias
            size = [max(8, round(n * less.scale)) for n in picture.shape[1::-1]]
            reduced = np.asarray(cv2.resize(colour, size, interpolation=cv2.INTER_AREA), np.uint8)
            less, colour = less @ Similarity(complex(picture.shape[1] / size[0])), reduced
        tile, mask, spot = _tile(colour, less)
        small.append(tile)
        cut.append(mask)
        at.append(spot)
        told("light")
    if len(small) == 1:
        return [_Matched(places[0], boxes[0], cut[0], lambda tile, spot, mask: tile, light)]
    kinds = [cv2.detail.EXPOSURE_COMPENSATOR_GAIN]
    if len(small) <= LOCAL_GAINS:
        kinds.append(cv2.detail.EXPOSURE_COMPENSATOR_GAIN_BLOCKS)
    compensators = []
    for kind in kinds:
        compensator = cv2.detail.ExposureCompensator.createDefault(kind)
        compensator.feed(at, [_umat(t) for t in small], [_umat(m) for m in cut])
        small = [np.asarray(compensator.apply(i, at[i], t, cut[i]), np.uint8) for i, t in enumerate(small)]
        compensators.append(compensator)

    def evener(index: int) -> Callable[[Image, tuple[int, int], Image], Image]:
        def even(tile: Image, spot: tuple[int, int], mask: Image) -> Image:
            for compensator in compensators:
                tile = np.asarray(compensator.apply(index, spot, tile, mask), np.uint8)
            return tile
        return even

    told("seams")
    finder = cv2.detail.DpSeamFinder("COLOR_GRAD")
    seams = finder.find([_umat(t.astype(np.float32)) for t in small], at, [_umat(m) for m in cut])
    grown = [np.asarray(cv2.dilate(seam.get(), np.ones((3, 3), np.uint8)), np.uint8) for seam in seams]
    return [_Matched(place, box, seam, evener(i), light)
            for i, (place, box, seam) in enumerate(zip(places, boxes, grown, strict=True))]


def _common_light(pictures: Sequence[Image]) -> NDArray[np.float32] | None:
    """What to multiply every picture by so that their mean is even: the lamp and the lens are the same in all; float32
    (h, w), small. None where pictures differ in size."""
    total, size = np.zeros((24, 32)), None
    for picture in pictures:
        if size not in (None, picture.shape[:2]):
            return None
        size = picture.shape[:2]
        small = np.asarray(cv2.resize(picture, (32, 24), interpolation=cv2.INTER_AREA), np.float64)
        total += small if small.ndim == 2 else small.mean(axis=2)
    mean = cv2.GaussianBlur(total / len(pictures), (0, 0), 2.0, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(np.clip(mean.mean() / np.maximum(mean, 1.0), 0.3, 3.0), np.float32)


def _lit(picture: Image, light: NDArray[np.float32] | None) -> Image:
    if light is None:
        return picture
    gain = np.asarray(cv2.resize(light, picture.shape[1::-1], interpolation=cv2.INTER_CUBIC))
    return np.asarray(np.clip(picture * (gain if picture.ndim == 2 else gain[:, :, None]), 0, 255), np.uint8)


def _blend(pictures: Sequence[Image], matched: Sequence[_Matched], box: Box, told: Told) -> Image | None:
    """A block of the mosaic, uint8 (h, w, 3); None where no picture reaches."""
    wide = box[0] - MARGIN, box[1] - MARGIN, box[2] + MARGIN, box[3] + MARGIN
    blender = cv2.detail.MultiBandBlender()
    blender.setNumBands(BANDS)
    blender.prepare((wide[0], wide[1], wide[2] - wide[0], wide[3] - wide[1]))
    any_fed = False
    for tile, mask, spot in _tiles(pictures, matched, wide):
        blender.feed(tile.astype(np.int16), mask, spot)
        any_fed = True
        told("blending")
    if not any_fed:
        return None
    blended, covered = blender.blend(np.empty(0, np.int16), np.empty(0, np.uint8))
    out = np.clip(blended, 0, 255).astype(np.uint8)
    out[np.asarray(covered) == 0] = 0
    return out[MARGIN:MARGIN + box[3] - box[1], MARGIN:MARGIN + box[2] - box[0]]


def _tiles(pictures: Sequence[Image], matched: Sequence[_Matched],
           wide: Box) -> Iterator[tuple[Image, Image, tuple[int, int]]]:
    """Tiles that reach into a box, cut to it."""
    for index, how in enumerate(matched):
        if how.box[0] >= wide[2] or how.box[1] >= wide[3] or how.box[2] <= wide[0] or how.box[3] <= wide[1]:
            continue
        tile, mask, (x, y) = how.tile(pictures[index])
        left, top = max(wide[0] - x, 0), max(wide[1] - y, 0)
        right, bottom = min(wide[2] - x, tile.shape[1]), min(wide[3] - y, tile.shape[0])
        if right > left and bottom > top:
            yield (np.ascontiguousarray(tile[top:bottom, left:right]),
                   np.ascontiguousarray(mask[top:bottom, left:right]), (x + left, y + top))


def _umat(image: NDArray[np.generic]) -> cv2.UMat:
    make: Callable[..., cv2.UMat] = cv2.UMat  # OpenCV's type stubs leave out the constructor from an array
    return make(np.ascontiguousarray(image))
