# SPDX-License-Identifier: Apache-2.0
"""Optical flow: where a grid of windows of one frame lies in the next (the paper's figure 6)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats
from signum.measure.measurer import Measurer, View
from signum.measure.validity import REASONS, Rules

LONELY = "support"
"""Reason to refuse a displacement that none of the windows beside it has."""


@dataclass(frozen=True, eq=False)
class FlowField:
    """Displacements of a grid of windows.

    Attributes:
        x: (nx,) and y: (ny,) window centres in the first frame, pixels.
        dx: (ny, nx) displacement to the second frame, pixels right; NaN where the measurement is not valid.
        dy: the same, pixels down.
        score: (ny, nx) matching fraction.
        refused: measurements that are not valid, counted by the reason.
    """

    x: Floats
    y: Floats
    dx: Floats
    dy: Floats
    score: Floats
    refused: Mapping[str, int] = field(default_factory=dict)

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(ny, nx): which measurements are valid."""
        return np.isfinite(self.dx)

    def dominant(self) -> tuple[float, float]:
        """The image's overall displacement, pixels: the median of the valid measurements; (0, 0) without any."""
        if not self.valid.any():
            return 0.0, 0.0
        return float(np.nanmedian(self.dx)), float(np.nanmedian(self.dy))


def measure_flow(
    measurer: Measurer, before: View, after: View, window: tuple[int, int] = (64, 64), step: int = 32,
    reach: tuple[int, int] = (16, 16), guess: tuple[float, float] = (0.0, 0.0), rules: Rules | None = None,
    support: int = 0,
) -> FlowField:
    """Measure the flow between two views.

    Args:
        measurer: took both views.
        before: the earlier view.
        after: the later one.
        window: width and height, pixels.
        step: grid spacing, pixels.
        reach: search range around `guess`, across and down, pixels.
        guess: expected displacement, pixels.
        rules: what makes a measurement valid; the measurer's own where None.
        support: number of a window's eight neighbours that must agree with it for it to be valid. With 1, a lone false
            match is refused, and so is an object that moves by itself and fills a single window.

    Raises:
        ValueError: if no window fits the picture.
    """
    width, height = measurer.size
    x = np.arange(window[0] // 2, width - window[0] + window[0] // 2 + 1, step)
    y = np.arange(window[1] // 2, height - window[1] + window[1] // 2 + 1, step)
    if not (x.size and y.size):
        raise ValueError(f"no window of {window[0]}x{window[1]} fits a picture of {width}x{height}")
    shape = (y.size, x.size)
    centres = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    found = measurer.measure_windows(before, after, centres, window, guess, reach, rules)
    dx, dy = (np.where(found.valid, values, np.nan).reshape(shape) for values in (found.dx, found.dy))
    lonely = np.isfinite(dx) & (_agreeing(dx, dy) < support)
    refused = Counter(str(REASONS[k]) for k in found.reasons[~found.valid].tolist()) + Counter(
        {LONELY: int(lonely.sum())})
    dx[lonely], dy[lonely] = np.nan, np.nan
    return FlowField(x.astype(np.float64), y.astype(np.float64), dx, dy, found.score.reshape(shape), refused)


def _agreeing(dx: Floats, dy: Floats) -> NDArray[np.int64]:
    """How many of the eight neighbours of each window agree with it: within a pixel and a quarter of its motion."""
    motion = np.pad(dx + 1j * dy, 1, constant_values=complex(np.nan, np.nan))
    here = motion[1:-1, 1:-1]
    height, width = here.shape
    count = np.zeros(here.shape, np.int64)
    for j in range(3):
        for i in range(3):
            if (i, j) != (1, 1):
                count += np.abs(motion[j:j + height, i:i + width] - here) <= 1.0 + 0.25 * np.abs(here)
    return count
