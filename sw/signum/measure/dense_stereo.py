# SPDX-License-Identifier: Apache-2.0
"""Stereo range at every pixel, by the dense engine: disparities of the windows around all pixels of a rectified pair.

A disparity is left x minus right x, as in `stereo`. It is valid where the peak is high enough, lies inside the search,
stands out from the rest of its row, and is what the right view's window finds, too. Three causes of errors are met:

- Where the texture repeats along the row or is weak, the rest of the row matches nearly as well. Windows half and twice
  as large have the same peak only if it is true: with one of them on its side a smaller margin is enough.
- A window at the edge of a near object covers two depths and mostly yields the nearer one, up to half its side outside
  the object. Beside something farther, a disparity therefore must be that of the half window, too.
- What is seen by the left camera only has no place in the right view: chance matches there differ from pixel to pixel,
  and patches of few pixels are refused.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats
from signum.measure.measurer import Measurer, View
from signum.measure.stereo import RangeMap
from signum.measure.subpixel import CONE_FROM, line_offsets
from signum.measure.validity import Reason
from signum.measure.winners import NONE, REACH, search_places, search_winners

Flags = NDArray[np.bool_]
T = TypeVar("T", bound=np.generic)
PATCH = "patch"
"""Reason to refuse a pixel whose patch of like disparities is small."""


@dataclass(frozen=True)
class DenseStereoRules:
    """What makes the disparity of a pixel valid. Scores are matching fractions.

    Attributes:
        min_score: least score of the peak.
        min_margin: by how much it must exceed the rest of its row.
        supported_margin: the same where a window of half or twice the side agrees.
        agreement_px: largest difference of disparities that agree.
        edge_px: difference from which a disparity nearby counts as farther.
        edge_reach: how far from something farther the half window must agree, windows.
        patch: least size of a patch of like disparities, windows.
    """

    min_score: float = 0.62
    min_margin: float = 0.1
    supported_margin: float = 0.02
    agreement_px: float = 1.0
    edge_px: float = 3.0
    edge_reach: float = 0.75
    patch: float = 1.0


@dataclass(frozen=True, eq=False)
class _Map:
    """One size of window, at every pixel of the left view, (H, W): the window with this pixel in its middle.

    `disparity` is NaN where nothing was found, `inside` whether both neighbours of the peak were searched, `returns`
    whether the right view agrees.
    """

    disparity: Floats
    score: Floats
    margin: Floats
    inside: Flags
    returns: Flags


def measure_dense_range(measurer: Measurer, left: View, right: View, disparities: tuple[int, int], window: int = 16,
                        step: int = 1, rules: DenseStereoRules | None = None) -> RangeMap:
    """Measure the disparity of every `step`-th pixel.

    Args:
        measurer: took both views, on a board with the dense engine.
        left: rectified left view.
        right: the right one of the same moment.
        disparities: smallest and largest to search, pixels.
        window: side of the windows, pixels.
        step: pixels from one column and row of the map to the next; the first is 0. The board searches every pixel,
            as the check of the edges takes them all.
        rules: what makes a disparity valid.

    Raises:
        ValueError: if there are fewer than three disparities to search, one is beyond REACH either way, `step` is less
            than 1, or no engine has such windows.
        BoardError: if the board has no dense engine, or not of this window.
    """
    if disparities[1] < disparities[0] + 2:
        raise ValueError("search at least three disparities")
    if max(-disparities[0], disparities[1]) > REACH:
        raise ValueError(f"disparities from {disparities[0]} to {disparities[1]}: must lie in {-REACH}..{REACH}")
    if step < 1:
        raise ValueError(f"step is {step}: must be 1 or more")
    rules = rules or DenseStereoRules()
    found = _measure_map(measurer, left, right, disparities, window)
    smaller, larger = (_measure_map(measurer, left, right, disparities, side) if side in measurer.dense_windows
                       and side <= min(measurer.size) else None for side in (window // 2, 2 * window))
    half, double = (None if other is None else np.abs(other.disparity - found.disparity) <= rules.agreement_px
                    for other in (smaller, larger))
    supported = np.zeros(found.inside.shape, bool)
    for agreeing in (half, double):
        if agreeing is not None:
            supported |= agreeing
    reasons: dict[str, Flags] = {
        Reason.OUTSIDE: np.isnan(found.disparity), Reason.SCORE: found.score < rules.min_score,
        Reason.MARGIN: found.margin < np.where(supported, rules.supported_margin, rules.min_margin),
        Reason.BORDER: ~found.inside, Reason.RETURN: ~found.returns}
    good = ~np.any(list(reasons.values()), axis=0)
    if half is not None:
        reasons[Reason.PARTS] = good & ~half & _beside_farther(found.disparity, good, window, rules)
        good &= ~reasons[Reason.PARTS]
    reasons[PATCH] = good & ~_in_patches(found.disparity, good, rules.patch * window**2, rules.agreement_px)
    good &= ~reasons[PATCH]
    thin = slice(None, None, step)
    y, x = (np.arange(0, size, step).astype(np.float64) for size in good.shape)
    return RangeMap(x, y, np.where(good, found.disparity, np.nan)[thin, thin], found.score[thin, thin],
                    found.margin[thin, thin], _counted({reason: bad[thin, thin] for reason, bad in reasons.items()}))


def _counted(reasons: Mapping[str, Flags]) -> dict[str, int]:
    """Pixels by the first reason that refuses them."""
    left, counts = np.ones(next(iter(reasons.values())).shape, bool), {}
    for reason, bad in reasons.items():
        counts[str(reason)] = int((left & bad).sum())
        left &= ~bad
    return {reason: count for reason, count in counts.items() if count}


def _measure_map(measurer: Measurer, left: View, right: View, disparities: tuple[int, int], window: int) -> _Map:
    low, high = disparities
    area = float(window**2)
    found = search_winners(measurer, (left, right), window, (-high, -low))
    returns = found.returned(lambda: search_places(measurer, (right, left), window, (low, high)))
    before, best, after = found.around[1].astype(np.float64)
    inside = (before < NONE) & (after < NONE)
    score = 1 - best / area
    offset = line_offsets(1 - before / area, score, 1 - after / area, score >= CONE_FROM)
    disparity = np.where(found.found, -found.dx - np.where(inside, offset, 0.0), np.nan)
    margin = np.minimum(found.rest, area) / area - best / area
    return _Map(_centred(disparity, window, np.nan), _centred(np.where(found.found, score, 0.0), window, 0.0),
                _centred(np.where(found.found, margin, 0.0), window, 0.0), _centred(inside, window, False),
                _centred(returns, window, False))


def _centred(values: NDArray[T], window: int, outside: object) -> NDArray[T]:
    """Values of windows by their last pixels as values by their middles; `outside` where no window has its middle."""
    out = np.full_like(values, outside)
    lag = window // 2 - 1
    out[:len(values) - lag, :values.shape[1] - lag] = values[lag:, lag:]
    return out


def _beside_farther(disparity: Floats, good: Flags, window: int, rules: DenseStereoRules) -> Flags:
    """Which pixels have something farther nearby."""
    side = 2 * round(rules.edge_reach * window) + 1
    far = np.where(good, disparity, np.inf).astype(np.float32)
    return np.asarray(cv2.erode(far, np.ones((side, side), np.uint8)) < disparity - rules.edge_px)


def _in_patches(disparity: Floats, good: Flags, size: float, like_px: float) -> Flags:
    """Which pixels belong to a patch of `size` pixels or more, from pixel to pixel of like disparities."""
    parts = 16
    whole = np.where(good, np.rint(parts * disparity), -(1 << 14)).astype(np.int16)
    cv2.filterSpeckles(whole, -(1 << 14), int(size), parts * like_px)
    return np.asarray(whole > -(1 << 14))
