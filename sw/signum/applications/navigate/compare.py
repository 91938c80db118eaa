# SPDX-License-Identifier: Apache-2.0
"""Compares a frame, window by window, with the part of the mosaic that a guess predicts it shows; board pixels."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from signum.applications.navigate.chart import Chart, filled
from signum.applications.navigate.coarse import spread, whole
from signum.applications.navigate.place import LocaliseLimits
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity, fit, vote
from signum.measure.measurer import Measurement, Measurer, Query
from signum.measure.validity import Reason

MOST_WINDOWS = (9, 7)
"""Largest number of windows across and down."""


@dataclass(frozen=True)
class Comparison:
    """Similarity frame -> chart, the windows that agree with it, of those tried, and their median score."""

    similarity: Similarity
    agreed: int = 0
    tried: int = 0
    score: float = 0.0


class Comparer:
    """Compares frames of one size with a chart.

    Args:
        measurer: makes a measurer for a picture size (width, height) and a sigma.
        size: width and height of the frames.
        chart: at the frames' scale.
        window: side of the windows.
        sigma: of the LoG.
        limits: of residuals, rotation, scale and search range; rules of the measurements.
    """

    def __init__(self, measurer: Callable[[tuple[int, int], float], Measurer], size: tuple[int, int], chart: Chart,
                 window: int, sigma: float, limits: LocaliseLimits) -> None:
        self._make, self._size, self._chart, self._window = measurer, size, chart, window
        self._sigma, self._limits = sigma, limits
        self._picture = filled(chart)
        self._measurer: Measurer | None = None

    def forget(self) -> None:
        """Make a new measurer for the next comparison: another one has used the board."""
        self._measurer = None

    def compare(self, live: Image, guess: Similarity) -> Comparison:
        """Compare windows over the whole frame with what it should show by `guess`."""
        window, limits = self._window, self._limits
        across, down = (min(most, max(2, math.ceil(1.5 * (n - window) / window)))
                        for most, n in zip(MOST_WINDOWS, self._size, strict=True))
        p, q, answers = self._measure(live, guess, spread(window, self._size, (across, down)), limits.reach)
        tried = sum(m.reason is not Reason.TEXTURE for m in answers)
        if len(p) < 3:
            return Comparison(guess, len(p), tried)
        tolerance = limits.miss * window
        start, _ = vote(p, q, tolerance, limits.rot_deg, limits.zoom, 0.75 * window)
        result = fit(p, q, start, tolerance)
        scores = np.array([m.score for m in answers if m.valid])[result.agree]
        if not scores.size:
            return Comparison(guess, 0, tried)
        return Comparison(guess @ result.similarity.inverse, scores.size, tried, float(np.median(scores)))

    def around(self, live: Image, guess: Similarity, middle: Floats, step: int
               ) -> tuple[Floats, Floats, list[Measurement]]:
        """Nine windows, `step` pixels apart, around a point of the frame: centres (n, 2) of the valid ones in the
        predicted picture, their positions (n, 2) in the frame, and all measurements."""
        x, y = (int(v) for v in middle)
        centres = [(x + i * step, y + j * step) for j in (-1, 0, 1) for i in (-1, 0, 1)]
        return self._measure(live, guess, centres, self._limits.reach // 2)

    def _measure(self, live: Image, guess: Similarity, centres: Sequence[tuple[int, int]], reach: int
                 ) -> tuple[Floats, Floats, list[Measurement]]:
        """Search for windows of the predicted picture in the frame, as `around` returns them; windows that are not on
        the mosaic are left out."""
        flags = cv2.WARP_INVERSE_MAP
        expected = cv2.warpAffine(self._picture, guess.matrix, self._size, flags=flags | cv2.INTER_LINEAR,
                                  borderMode=cv2.BORDER_REPLICATE)
        covered = cv2.warpAffine(self._chart.covered, guess.matrix, self._size, flags=flags | cv2.INTER_NEAREST)
        inside = cv2.integral(np.asarray(covered > 0, np.uint8))
        kept = [c for c in centres if whole(inside, c, self._window)]
        if not kept:
            return np.zeros((0, 2)), np.zeros((0, 2)), []
        measurer = self._measurer = self._measurer or self._make(self._size, self._sigma)
        reference, view = measurer.view(np.asarray(expected, np.uint8)), measurer.view(live)
        answers = measurer.measure([Query(reference, view, x, y, self._window, self._window, reach=(reach, reach))
                                    for x, y in kept], self._limits.rules)
        measurer.release(reference)
        measurer.release(view)
        good = [i for i, m in enumerate(answers) if m.valid]
        p = np.array([kept[i] for i in good], np.float64).reshape(-1, 2)
        moved = np.array([[answers[i].dx_px, answers[i].dy_px] for i in good], np.float64).reshape(-1, 2)
        return p, p + moved, answers
