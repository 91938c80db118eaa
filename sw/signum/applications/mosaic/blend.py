# SPDX-License-Identifier: Apache-2.0
"""One picture from many: frames warped into the mosaic plane, their light evened out, one chosen for each place.

Every place is shown by one frame, as sharp as it is: at a seam the detail changes within a pixel, and only what is
coarser goes over smoothly. Pictures are read twice or more, so a sequence that loads them when asked for keeps a large
survey's frames out of memory: light and seams are worked out on small copies, and the picture is made block by block.
See `photometry` for the light, `seams` for the choice.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.applications.mosaic.photometry import fit_light, shrink
from signum.applications.mosaic.seams import ALONE, Layer, Seams, calm, grid_scale, lay, softened, specks_of
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import IDENTITY, Similarity, corners

MOST_PIXELS = 100_000_000
"""Most pixels of a mosaic; a larger one is made at a smaller scale."""
SEAM_PIXELS = 20_000
"""About how many pixels the small copy of a frame has that seams are found on."""
COPIES_BYTES = 64_000_000
"""Memory for the small copies; those of a larger survey are made again when they are needed."""
LATEST = 64
"""Frames of which what is compared is kept, up to 0.3 MB each."""
BLOCK = 1536
"""Side of the blocks blended at a time, pixels of the mosaic."""
FINE = 3.0
"""Detail finer than a Gaussian of this width, pixels of the mosaic, changes from frame to frame within a pixel."""
FEATHER, AROUND = 4.0, 12
"""What is coarser goes over as smoothly as a Gaussian of this width, pixels of the seams' grid; what is looked at
beside a block and a frame's part for that."""
RIM = 3
"""Pixels left out along the frames' edges, where cameras and scanners leave marks."""
STRONGEST, BRIGHT = 4.0, 200.0
"""Most by which a colour, and the whole, is raised to take the water's tint away; the grey level that the brightest
hundredth then reaches."""

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
            block: int = BLOCK, told: Told = silent, water: bool = False) -> Mosaic:
    """Blend pictures.

    Args:
        pictures: uint8 (H, W) or (H, W, 3), at least one; grey and colour may be mixed.
        places: pixels of each picture -> mosaic plane.
        most_pixels: of the mosaic.
        block: side of what is blended at a time, pixels.
        told: called as the work goes on.
        water: whether to take the tint of the water out of colour pictures: the mosaic is grey on average, and bright.
    """
    plan = Composition(pictures, places, most_pixels, told, water)
    width, height = plan.size
    out = np.zeros((height, width) if plan.grey else (height, width, 3), np.uint8)
    for top in range(0, height, block):
        for left in range(0, width, block):
            box = left, top, min(left + block, width), min(top + block, height)
            part = plan.block(box)
            if part is not None:
                out[box[1]:box[3], box[0]:box[2]] = part
    return Mosaic(out, plan.origin, plan.scale)


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


@dataclass(frozen=True, eq=False)
class _Part:
    """What a frame contributes to a block.

    Attributes:
        here: rows and columns of the block.
        tile: the frame's picture there, its light evened out.
        shown: where its detail is shown.
        share: its weight in what is coarser, 0..1.
    """

    here: tuple[slice, slice]
    tile: Image
    shown: NDArray[np.bool_]
    share: NDArray[np.float32]


class Composition:
    """A mosaic whose parts are made when they are asked for; arguments as `compose`.

    Attributes:
        size: width and height of the mosaic, pixels.
        origin, scale: as those of `Mosaic`.
        grey: whether all pictures are.
    """

    def __init__(self, pictures: Sequence[Image], places: Sequence[Similarity], most_pixels: int = MOST_PIXELS,
                 told: Told = silent, water: bool = False) -> None:
        self._pictures, self._told = pictures, told
        self._copies: OrderedDict[int, tuple[Image, Image]] = OrderedDict()
        self._latest: OrderedDict[int, tuple[NDArray[np.float32], NDArray[np.float32]]] = OrderedDict()
        self._sizes, thumbs, self.grey = [], [], True
        for number, picture in enumerate(pictures):
            self._sizes.append((picture.shape[1], picture.shape[0]))
            self.grey = self.grey and picture.ndim == 2
            thumbs.append(shrink(self._keep(number, picture)[0]))
            told("light")
        low, high = bounds(self._sizes, places)
        extent = high - low + 1
        self.scale = min(1.0, float(np.sqrt(most_pixels / (extent[0] * extent[1]))))
        self.size = int(np.ceil(extent[0] * self.scale)), int(np.ceil(extent[1] * self.scale))
        self.origin = float(low[0]), float(low[1])
        view = Similarity(complex(self.scale), -self.scale * complex(*self.origin))
        self._places = [view @ place for place in places]
        boxes = [bounds([size], [place]) for size, place in zip(self._sizes, self._places, strict=True)]
        self._boxes = np.array([[*a, *(b + 1)] for a, b in boxes])
        thumbs = thumbs if self.grey else [_coloured(thumb) for thumb in thumbs]
        self._light = fit_light(thumbs, self._sizes, places)
        self._clearing = _clearing(thumbs) if water and not self.grey else np.ones(1)
        told("seams")
        self._grid = grid_scale(self._sizes, self._places[0].scale, SEAM_PIXELS)
        self._seams = Seams(self._layers)

    def block(self, box: Box) -> Image | None:
        """A part of the mosaic, uint8 (h, w) or (h, w, 3), black where no frame is; None where no picture reaches."""
        grid = self._grid
        cut = [n // grid - AROUND for n in box[:2]] + [-(-n // grid) + AROUND for n in box[2:]]
        if not len(self._within([grid * n for n in cut])):
            return None
        shape = grid * (cut[3] - cut[1]), grid * (cut[2] - cut[0])
        channels = () if self.grey else (3,)
        detail, coarse = (np.zeros((*shape, *channels), np.float32) for _ in range(2))
        weight, covered = np.zeros(shape, np.float32), np.zeros(shape, bool)
        for part in self._parts(cut):
            here = part.here
            smooth = np.asarray(cv2.GaussianBlur(calm(part.tile), (0, 0), FINE, borderType=cv2.BORDER_REPLICATE))
            cv2.copyTo(np.asarray(cv2.subtract(part.tile, smooth, dtype=cv2.CV_32F)), part.shown.astype(np.uint8),
                       detail[here])
            coarse[here] += smooth * _like(part.share, smooth)
            weight[here] += part.share
            covered[here] |= part.shown
            self._told("blending")
        left, top = box[0] - grid * cut[0], box[1] - grid * cut[1]
        inner = np.s_[top:top + box[3] - box[1], left:left + box[2] - box[0]]
        whole = detail[inner] + coarse[inner] / _like(np.maximum(weight[inner], 1e-6), coarse)
        out = np.asarray(cv2.convertScaleAbs(np.maximum(whole, 0)), np.uint8)
        out[~covered[inner]] = 0
        return out

    def _within(self, box: Sequence[float]) -> NDArray[np.intp]:
        """Numbers of the frames that reach into a box of the mosaic."""
        b = self._boxes
        return np.flatnonzero((b[:, 0] < box[2]) & (b[:, 1] < box[3]) & (b[:, 2] > box[0]) & (b[:, 3] > box[1]))

    def _keep(self, number: int, picture: Image) -> tuple[Image, Image]:
        """Make the small copy of a picture, and that of its specks, and keep them while there is room."""
        less = min(1.0, float(np.sqrt(SEAM_PIXELS / (picture.shape[0] * picture.shape[1]))))
        size = max(8, round(picture.shape[1] * less)), max(8, round(picture.shape[0] * less))
        copy = np.asarray(cv2.resize(calm(picture), size, interpolation=cv2.INTER_AREA), np.uint8)
        self._copies[number] = copy, specks_of(picture, size)
        while len(self._copies) * 2 * copy.nbytes > COPIES_BYTES:
            self._copies.popitem(last=False)
        return self._copies[number]

    def _copy(self, number: int) -> tuple[Image, Image]:
        """The small copy of a picture, and that of its specks, made again where they were not kept."""
        if number not in self._copies:
            return self._keep(number, self._pictures[number])
        self._copies.move_to_end(number)
        return self._copies[number]

    def _lit(self, number: int, picture: Image, clearing: Floats) -> Image:
        """A picture, or its small copy, with its light evened out and its colours multiplied by `clearing`, (channels,)
        or (1,); in colour unless all are grey."""
        picture = picture if self.grey else _coloured(picture)
        factor = (self._light.factor(number, self._sizes[number][::-1]) * clearing).astype(np.float32)
        factor = np.asarray(cv2.resize(factor, picture.shape[1::-1], interpolation=cv2.INTER_CUBIC))
        return np.asarray(cv2.convertScaleAbs(cv2.multiply(picture, factor, dtype=cv2.CV_32F)), np.uint8)

    def _compared(self, number: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """A frame's small copy and its specks, as `lay` takes them; those of the latest are kept, as tiles beside one
        another show the same frames."""
        found = self._latest.pop(number, None)
        if found is None:
            copy, specks = self._copy(number)
            found = softened(self._lit(number, copy, np.ones(1))), specks.astype(np.float32)
        self._latest[number] = found
        if len(self._latest) > LATEST:
            self._latest.popitem(last=False)
        return found

    def _layers(self, spot: tuple[int, int], shape: tuple[int, int]) -> list[Layer]:
        """The frames on a tile of the grid."""
        g = self._grid
        onto = Similarity(complex(1 / g), complex(*(0.5 / g - 0.5,) * 2))
        box = spot[0] * g, spot[1] * g, (spot[0] + shape[1]) * g, (spot[1] + shape[0]) * g
        layers = []
        for n in self._within(box).tolist():
            layers.append(lay(n, *self._compared(n), self._sizes[n], onto @ self._places[n], spot, shape, RIM))
        return [layer for layer in layers if np.isfinite(layer.cost).any()]

    def _parts(self, cut: Sequence[int]) -> Iterator[_Part]:
        """What each frame contributes to a box of the grid."""
        grid = self._grid
        labels = self._seams.over(cut[0], cut[1], cut[2], cut[3])
        for number in self._within([grid * n for n in cut]).tolist():
            reach = np.concatenate([self._boxes[number, :2] // grid, -(-self._boxes[number, 2:] // grid)]).astype(int)
            low, high = np.maximum(reach[:2] - cut[:2], 0), np.minimum(reach[2:], cut[2:]) - cut[:2]
            near = labels[low[1]:high[1], low[0]:high[0]]
            rows, columns = (np.flatnonzero(((near == number) | (near == ALONE)).any(axis=k)) for k in (1, 0))
            if not len(rows):
                continue
            top, bottom = max(low[1] + rows[0] - AROUND, 0), min(low[1] + rows[-1] + 1 + AROUND, labels.shape[0])
            left, right = max(low[0] + columns[0] - AROUND, 0), min(low[0] + columns[-1] + 1 + AROUND, labels.shape[1])
            own = labels[top:bottom, left:right]
            own = (own == number) | (own == ALONE)
            size = grid * int(right - left), grid * int(bottom - top)
            spot = grid * int(cut[0] + left), grid * int(cut[1] + top)
            tile, mask = _warped(self._lit(number, self._pictures[number], self._clearing), self._places[number], spot,
                                 size)
            shown = np.repeat(np.repeat(own, grid, 0), grid, 1) & (mask > 0)
            if shown.any():
                side = 2 * AROUND + 1
                share = cv2.resize(cv2.GaussianBlur(own.astype(np.float32), (side, side), FEATHER), size,
                                   interpolation=cv2.INTER_LINEAR)
                here = slice(grid * top, grid * bottom), slice(grid * left, grid * right)
                yield _Part(here, tile, shown, np.asarray(share * (mask > 0), np.float32))


def _like(plane: NDArray[np.float32], picture: NDArray[np.generic]) -> NDArray[np.float32]:
    """A plane (h, w) as one that goes with a picture, grey or colour."""
    return plane if picture.ndim == 2 else plane[..., None]


def _tile(picture: Image, place: Similarity) -> tuple[Image, Image, tuple[int, int]]:
    """A small copy warped whole, with its mask and the mosaic pixel of its corner."""
    framed = place(corners((picture.shape[1], picture.shape[0])))
    low = np.maximum(np.floor(framed.min(axis=0)), 0).astype(int)
    size = [max(1, int(v)) for v in np.ceil(framed.max(axis=0)).astype(int) - low + 1]
    spot = int(low[0]), int(low[1])
    return *_warped(picture, place, spot, (size[0], size[1]), 1), spot


def _warped(picture: Image, place: Similarity, spot: tuple[int, int], size: tuple[int, int], rim: int = RIM,
            ) -> tuple[Image, Image]:
    """What a picture shows of a box of the mosaic, its corner at `spot`, and where: 255, else 0."""
    onto = Similarity(shift=-complex(*spot)) @ place
    source, less = picture, IDENTITY
    if place.scale < 0.7:  # a warp alone would alias
        size_less = [max(8, round(n * place.scale)) for n in picture.shape[1::-1]]
        source = np.asarray(cv2.resize(picture, size_less, interpolation=cv2.INTER_AREA), np.uint8)
        wider = picture.shape[1] / size_less[0]
        less = Similarity(complex(wider), complex(*(wider / 2 - 0.5,) * 2))
    tile = cv2.warpAffine(source, (onto @ less).matrix, size, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    whole = np.zeros(picture.shape[:2], np.uint8)
    whole[rim:-rim, rim:-rim] = 255
    mask = cv2.warpAffine(whole, onto.matrix, size, flags=cv2.INTER_NEAREST)
    return np.asarray(tile, np.uint8), np.asarray(mask, np.uint8)


def _coloured(picture: Image) -> Image:
    return picture if picture.ndim == 3 else np.asarray(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR), np.uint8)


def _clearing(thumbs: Sequence[Image]) -> Floats:
    """What to multiply the colours by, (3,), so that they are equally strong on average, and the picture is bright."""
    levels = np.concatenate([thumb.reshape(-1, 3) for thumb in thumbs]).astype(np.float64)
    mean = np.maximum(levels.mean(axis=0), 1)
    factors = np.minimum(mean.mean() / mean, STRONGEST)
    brightest = float(np.percentile((levels * factors).mean(axis=1), 99))
    return np.asarray(factors * np.clip(BRIGHT / brightest, 1, STRONGEST), np.float64)
