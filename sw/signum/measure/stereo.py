# SPDX-License-Identifier: Apache-2.0
"""Stereo range: disparities of a grid of windows along the rows of a rectified pair (the paper's figure 5).

Each window of the left view is searched for along the same rows of the right view: a one-dimensional job. A disparity
is left x minus right x, positive for everything nearer than infinity. The measurer checks peak and margin, and that the
search from the right view back returns to the left window (left-right check). At the edge of a near object a window
covers two depths and may yield either; a window twice as large then yields another one, so the two must agree. At the
border the larger one is moved inwards until it lies in the left view.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats
from signum.frames.fit import Fit
from signum.geometry.calibration import StereoGeometry
from signum.measure.measurer import Measurement, Measurer, Query, View
from signum.measure.validity import Reason, Rules

STEREO_RULES = Rules(min_score=0.7, min_margin=0.05, max_return_px=0.6, texture=False)
"""Stricter than `Rules`: both views are of one moment, so they match better than two frames of a dive, and the best of
the places along one row stands out further. A window without texture along its row is like its neighbours in the row,
so it has no margin; what it looks like above and below does not matter."""
AGAIN = Rules(min_score=0.0, min_margin=-1.0, texture=False, backward=False)
"""For the windows twice as large: where these find something else, that may be as wrong as what they are to confirm."""


@dataclass(frozen=True, eq=False)
class RangeMap:
    """Disparities on a grid of window centres.

    Attributes:
        x: (nx,) and y: (ny,) centres, pixels of the left view.
        disparity: (ny, nx) pixels; NaN where the measurement is not valid.
        score: (ny, nx) of the measurements.
        margin: (ny, nx) of the measurements.
        refused: measurements that are not valid, counted by the reason.
    """

    x: Floats
    y: Floats
    disparity: Floats
    score: Floats
    margin: Floats
    refused: Mapping[str, int] = field(default_factory=dict)

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(ny, nx): which measurements are valid."""
        return np.isfinite(self.disparity)

    def to_source(self, fit: Fit) -> RangeMap:
        """The map in original pixels, of a pair scaled down for the board by `fit`."""
        xs, ys = np.stack([self.x, self.x], axis=1), np.stack([self.y, self.y], axis=1)
        return RangeMap(fit.to_source(xs)[:, 0], fit.to_source(ys)[:, 1], self.disparity * fit.factor[0], self.score,
                        self.margin, self.refused)

    def thinned(self, step: int) -> RangeMap:
        """Every `step`-th column and row of the map."""
        thin = slice(None, None, step)
        return RangeMap(self.x[thin], self.y[thin], self.disparity[thin, thin], self.score[thin, thin],
                        self.margin[thin, thin], self.refused)

    def points(self, geometry: StereoGeometry) -> Floats:
        """Valid points (n, 3), metres, right, down and forward of the left camera."""
        ys, xs = np.nonzero(self.valid)
        points = geometry.points(self.x[xs], self.y[ys], self.disparity[ys, xs])
        return np.asarray(points[np.isfinite(points).all(axis=1)])


def measure_range(
    measurer: Measurer, left: View, right: View, disparities: tuple[int, int], window: tuple[int, int] = (16, 16),
    step: int = 16, agreement_px: float | None = 1.0, rules: Rules = STEREO_RULES,
) -> RangeMap:
    """Measure a grid of disparities.

    Args:
        measurer: took both views.
        left: rectified left view.
        right: the right one of the same moment.
        disparities: smallest and largest to search, pixels.
        window: width and height of the windows, pixels.
        step: grid spacing, pixels.
        agreement_px: largest difference from the disparity of a window twice as large; None skips that measurement.
        rules: what makes a disparity valid.

    Raises:
        ValueError: if there are fewer than three disparities to search, or no window fits.
    """
    low, high = disparities
    if high < low + 2:
        raise ValueError("search at least three disparities")
    width, height = measurer.size
    x = np.arange(window[0] // 2, width - window[0] + window[0] // 2 + 1, step)
    y = np.arange(window[1] // 2, height - window[1] + window[1] // 2 + 1, step)
    if not (x.size and y.size):
        raise ValueError(f"no window of {window[0]}x{window[1]} fits a picture of {width}x{height}")
    guess, reach = -(low + high) / 2, -(-(high - low) // 2)

    def ask(size: tuple[int, int], rules: Rules) -> list[Measurement]:
        u, v = (np.clip(at, side // 2, whole - side + side // 2)  # moved inwards where the window would stick out
                for at, side, whole in zip((x, y), size, measurer.size, strict=True))
        return measurer.measure([Query(left, right, int(column), int(row), *size, guess=(guess, 0.0), reach=(reach, 0))
                                 for row in v for column in u], rules)

    found = ask(window, rules)
    shape = (y.size, x.size)
    disparity = np.array([-m.dx_px if m.valid else np.nan for m in found])
    refused = Counter(str(m.reason) for m in found if not m.valid)
    if agreement_px is not None:
        across, down = (min(2 * side, measurer.window_range[1], whole)
                        for side, whole in zip(window, measurer.size, strict=True))
        larger = ask((across, down), AGAIN)
        second = np.array([np.nan if m.reason is Reason.OUTSIDE else -m.dx_px for m in larger])
        alone = np.isfinite(disparity) & ~(np.abs(disparity - second) <= agreement_px)
        disparity[alone] = np.nan
        refused += Counter({str(Reason.PARTS): int(alone.sum())})
    return RangeMap(x.astype(np.float64), y.astype(np.float64), disparity.reshape(shape),
                    np.array([m.score for m in found]).reshape(shape),
                    np.array([m.margin for m in found]).reshape(shape), refused)
