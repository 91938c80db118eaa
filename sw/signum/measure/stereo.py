"""Stereo range: disparities of a grid of windows along the rows of a rectified pair (the paper's figure 5).

Each window of the left view is searched for along the same rows of the right view: a one-dimensional job. A disparity
is left x minus right x, positive for everything nearer than infinity. The measurer checks peak, margin, texture, and
that the search from the right view back returns to the left window (left-right check). At the edge of a near object a
window covers two depths and may yield either; a window twice as large then yields another one, so the two must agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image
from signum.frames.fit import Fit
from signum.geometry.calibration import StereoGeometry
from signum.measure.measurer import Measurement, Measurer, Query, Rules, View

SCALE_WIDTH = 64
"""Width of the colour scale beside a drawn map, pixels."""
STEREO_RULES = Rules(min_score=0.7, min_margin=0.02, max_return_px=0.6)
"""Stricter than `Rules`: both views are of one moment, so they match better than two frames of a dive."""


@dataclass(frozen=True, eq=False)
class RangeMap:
    """Disparities on a grid of window centres.

    Attributes:
        x: (nx,) and y: (ny,) centres, pixels of the left view.
        disparity: (ny, nx) pixels; NaN where the measurement is not valid.
        score, margin: (ny, nx) of the measurements.
    """

    x: Floats
    y: Floats
    disparity: Floats
    score: Floats
    margin: Floats

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(ny, nx): which measurements are valid."""
        return np.isfinite(self.disparity)

    def to_source(self, fit: Fit) -> RangeMap:
        """The map in original pixels, of a pair scaled down for the board by `fit`."""
        xs, ys = np.stack([self.x, self.x], axis=1), np.stack([self.y, self.y], axis=1)
        return RangeMap(fit.to_source(xs)[:, 0], fit.to_source(ys)[:, 1], self.disparity * fit.factor[0], self.score,
                        self.margin)

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
        left: rectified left view; right: the right one of the same moment.
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

    def ask(size: tuple[int, int]) -> list[Measurement]:
        return measurer.measure([Query(left, right, int(u), int(v), *size, guess=(guess, 0.0), reach=(reach, 0))
                                 for v in y for u in x], rules)

    found = ask(window)
    shape = (y.size, x.size)
    disparity = _disparities(found)
    if agreement_px is not None:
        most = measurer.window_range[1]
        second = _disparities(ask((min(2 * window[0], most), min(2 * window[1], most))))
        disparity[~(np.abs(disparity - second) <= agreement_px)] = np.nan
    return RangeMap(x.astype(np.float64), y.astype(np.float64), disparity.reshape(shape),
                    np.array([m.score for m in found]).reshape(shape),
                    np.array([m.margin for m in found]).reshape(shape))


def _disparities(found: list[Measurement]) -> Floats:
    return np.array([-m.dx_px if m.valid else np.nan for m in found])


def write_ply(path: Path, points: Floats) -> None:
    """Write points (n, 3) in metres as an ASCII PLY file."""
    header = (f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n"
              "property float x\nproperty float y\nproperty float z\nend_header\n")
    path.write_text(header + "".join(f"{x:.5f} {y:.5f} {z:.5f}\n" for x, y, z in points))


def draw_range(found: RangeMap, geometry: StereoGeometry | None, picture: Image) -> Image:
    """The map in colour over the left picture, with its scale: metres with a geometry, pixels of disparity without.

    Args:
        found: the map.
        geometry: of the pair, or None.
        picture: uint8 (H, W), the left view.

    Returns:
        uint8 (H, W + SCALE_WIDTH, 3) blue, green, red; without colour where no measurement is valid.
    """
    values = found.disparity if geometry is None else geometry.depth(found.disparity)
    out = np.asarray(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR), np.uint8)
    seen = values[np.isfinite(values)]
    low, high = (float(v) for v in np.percentile(seen, (1, 99))) if seen.size else (0.0, 1.0)
    high = max(high, low + 1e-3)
    near_is_red = 1.0 if geometry is None else -1.0
    step_x, step_y = (int(a[1] - a[0]) if a.size > 1 else 16 for a in (found.x, found.y))
    for j, v in enumerate(found.y.astype(int)):
        for i, u in enumerate(found.x.astype(int)):
            if np.isfinite(values[j, i]):
                cell = out[max(v - step_y // 2, 0):v + (step_y + 1) // 2, max(u - step_x // 2, 0):u + (step_x + 1) // 2]
                cell[:] = np.asarray(0.35 * cell + 0.65 * _colour((values[j, i] - low) / (high - low), near_is_red))
    height = picture.shape[0]
    scale = np.full((height, SCALE_WIDTH, 3), 255, np.uint8)
    for y in range(8, height - 8):
        scale[y, 8:22] = _colour(1 - (y - 8) / (height - 16), near_is_red)
    for share in (0.0, 0.5, 1.0):
        y = round(height - 8 - share * (height - 16))
        cv2.putText(scale, f"{low + share * (high - low):.3g}", (25, min(max(y + 4, 12), height - 4)),
                    cv2.FONT_HERSHEY_SIMPLEX, 0.38, (0, 0, 0), 1, cv2.LINE_AA)
    return np.hstack([out, scale])


def _colour(share: float, sign: float) -> Image:
    """Blue (0) to red (1), or the other way round for a negative sign; uint8 (3,)."""
    share = min(max(share, 0.0), 1.0)
    level = np.array([[round(255 * (share if sign > 0 else 1 - share))]], np.uint8)
    return np.asarray(cv2.applyColorMap(level, cv2.COLORMAP_TURBO)[0, 0], np.uint8)
