# SPDX-License-Identifier: Apache-2.0
"""Deeper pictures in 8 bits: one linear mapping a source, chosen at its first picture and the same for all that follow.

The board's filter takes the sign of a Laplacian, which no positive factor changes: what matters is that the factor
stays the same over a run, and that the picture's levels are spread over the 8 bits.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Image
from signum.common.console import notes
from signum.common.errors import SourceError

SENSOR_BITS = 8, 10, 12, 14, 16, 24, 32
"""Bits of cameras and sonars: integers are mapped from the fewest of these that hold the first picture's largest."""
FAINTEST, BRIGHTEST = 1e-30, 1e30
"""Values of floating point that are told apart: fainter ones become 0, brighter ones this."""
CUT_SHARE = 0.01
"""Share of a picture's pixels beyond the mapping above which the user is told, once."""


class EightBits:
    """Maps pictures of any depth to 8 bits; 8-bit ones stay as they are.

    Integers: 0 to 2^bits - 1 becomes 0 to 255, where `bits` is the least of SENSOR_BITS that holds the first picture's
    largest value. Floating point: 0 to the least of 1, 2 and 5 times a power of ten that holds it becomes 0 to 255;
    NaN becomes 0, as do infinite values. Values beyond are cut off.

    Args:
        label: of the source, for the note to the user.
    """

    def __init__(self, label: str) -> None:
        self._label = label
        self._top: float | None = None
        self._warned = False

    @property
    def top(self) -> float | None:
        """The value that becomes 255; None before the first deeper picture."""
        return self._top

    def __call__(self, picture: NDArray[np.generic], name: str = "") -> Image:
        """The picture in 8 bits, same shape.

        Args:
            picture: numbers, (H, W) or (H, W, channels).
            name: of the frame, for messages.

        Raises:
            SourceError: if it holds no numbers that a picture can have.
        """
        if picture.dtype == np.uint8:
            return np.asarray(picture, np.uint8)
        if picture.dtype.kind == "b":
            return np.asarray(picture, np.uint8) * np.uint8(255)
        if picture.dtype.kind not in "uif":
            raise SourceError(f"{self._label}: {name}: pixels of type {picture.dtype}; expected whole or real numbers")
        values: NDArray[Any] = picture
        if picture.dtype.kind == "f":
            kind = np.float64 if picture.dtype.itemsize > 4 else np.float32
            values = np.nan_to_num(np.asarray(picture, kind), nan=0.0, posinf=0.0, neginf=0.0)
            values = np.where(np.abs(values) < FAINTEST, 0, np.minimum(values, kind(BRIGHTEST)))
        if self._top is None:
            self._top = self._choose(values)
        over = float(np.mean(values > self._top))
        if over > CUT_SHARE and not self._warned:
            self._warned = True
            notes.print(f"{self._label}: {name}: {over:.0%} of the pixels exceed {self._top:g}, which the first "
                        "picture set as white; they are cut off there")
        if values.dtype.kind == "f":
            return np.asarray(np.clip(np.rint(values * values.dtype.type(255 / self._top)), 0, 255), np.uint8)
        shift = round(math.log2(self._top + 1)) - 8
        return np.asarray(np.clip(values, 0, int(self._top)).astype(np.int64) >> shift, np.uint8)

    def _choose(self, values: NDArray[Any]) -> float:
        largest = float(values.max(initial=0))
        if values.dtype.kind == "f":
            step = 10.0 ** math.floor(math.log10(largest)) if largest > 0 else 1.0
            top = next(k * step for k in (1, 2, 5, 10) if largest <= k * step * (1 + 1e-6))
        else:
            top = float(2 ** next((b for b in SENSOR_BITS if largest < 2**b), 64) - 1)
        notes.print(f"{self._label}: pictures of {8 * values.dtype.itemsize} bits; 0 to {top:g} becomes 0 to 255, the "
                    "same for the whole run")
        return top
