# SPDX-License-Identifier: Apache-2.0
"""Sign of the Laplacian of Gaussian, frame level: the specification of the board's front end in integers.

The response is that of `scipy.ndimage.gaussian_laplace`: sampled kernels, `g2(y) g(x) + g(y) g2(x)`, on an image
continued by its border pixels (`cv2.BORDER_REPLICATE`, scipy's mode "nearest"):

1. down the columns: `v = (sum g(k) p(y + k) + 64) >> 7` and `v2` by the same formula with `g2`;
2. along the rows, unrounded: `response = sum g2(k) v(x + k) + g(k) v2(x + k)`;
3. `sign = response > 0`.

`g` sums to exactly 2**15 and `g2` to exactly 0, so constants and linear ramps respond with exactly 0.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
import numpy.typing as npt

from golden.params import COEF_FRACTION, FULL

ONE = 1 << COEF_FRACTION
"""Sum of `g`, and the largest sum of the positive taps of `g2`."""
ROUND_BITS = 7
"""Fraction bits dropped, rounding half up, between the passes."""
NARROWEST_SIGMA = 0.6
"""Narrowest Gaussian that pixels still sample well, pixels; the boards take sigma from `golden.params.MIN_SIGMA` on."""

Image = npt.NDArray[np.uint8]
Coefs = tuple[int, ...]
"""Half of a symmetric kernel: the centre, then one coefficient per distance."""


def widest_sigma(radius: int) -> float:
    """Sigma of the widest Gaussian for a kernel of `radius`, which must reach two sigmas; both in pixels."""
    return radius / 2


@lru_cache(maxsize=64)
def kernels(sigma: float, radius: int = FULL.radius) -> tuple[Coefs, Coefs]:
    """Coefficients of the smoothing kernel and of its second derivative.

    Args:
        sigma: standard deviation of the Gaussian in pixels, `NARROWEST_SIGMA` to `widest_sigma(radius)`.
        radius: distance of the outermost taps in pixels, at least 1.

    Returns:
        `(g, g2)`, each `radius + 1` signed integers: the centre first, then one per distance. `g` is in units of
        2**-15; `g2` is scaled so that its positive taps come as near 2**15 as possible without exceeding it.

    Raises:
        ValueError: for a sigma the kernel cannot hold.
    """
    if radius < 1 or not NARROWEST_SIGMA <= sigma <= widest_sigma(radius):
        raise ValueError(f"sigma {sigma} is outside {NARROWEST_SIGMA}..{widest_sigma(radius)} for radius {radius}")
    x = np.arange(radius + 1, dtype=np.float64)
    gauss = np.exp(-0.5 * (x / sigma) ** 2)
    gauss /= _full_sum(gauss)
    curve = ((x / sigma) ** 2 - 1) * gauss
    # Truncation and sampling leave a mean; it is taken out in proportion to the Gaussian: the tails keep their shape.
    curve -= _full_sum(curve) * gauss
    curve *= ONE / (2 * curve[curve > 0].sum())
    return _to_integers(gauss * ONE, ONE), _to_integers(curve, 0)


def response(image: Image, sigma: float, radius: int = FULL.radius) -> npt.NDArray[np.int64]:
    """LoG response of a grey image.

    Args:
        image: uint8 (H, W), any size of at least one pixel (the board takes `2 * radius + 2` or more each way).
        sigma: as in `kernels`.
        radius: as in `kernels`.

    Returns:
        int64 (H, W), within +-2**34; its scale depends on sigma.

    Raises:
        ValueError: if `image` is not an 8-bit grey image, or for a bad sigma.
    """
    return respond(image, *kernels(sigma, radius))


def respond(image: Image, g: Coefs, g2: Coefs) -> npt.NDArray[np.int64]:
    """Response of `image` to the kernels `g` and `g2`; values, shape and errors as `response`."""
    if image.ndim != 2 or image.dtype != np.uint8 or image.size == 0:
        raise ValueError(f"expected an 8-bit grey image, not {image.dtype} {image.shape}")
    # Every product and partial sum is an integer below 2**24 down the columns and below 2**53 along the rows: both
    # float formats are exact here, in whatever order OpenCV adds.
    rows = [_vertical(image, k) for k in (g, g2)]
    total = _horizontal(rows[0], g2) + _horizontal(rows[1], g)
    return total.astype(np.int64)


def sign(image: Image, sigma: float, radius: int = FULL.radius) -> Image:
    """Sign plane of a grey image: uint8 (H, W), 1 where the response is > 0, else 0. Arguments as `response`."""
    return binarise(image, *kernels(sigma, radius))


def binarise(image: Image, g: Coefs, g2: Coefs) -> Image:
    """Sign plane of `image` for the kernels `g` and `g2`; see `sign`."""
    return (respond(image, g, g2) > 0).astype(np.uint8)


def _vertical(image: Image, half: Coefs) -> npt.NDArray[np.float64]:
    taps = np.array([*half[:0:-1], *half], dtype=np.float32)
    total = cv2.sepFilter2D(image, cv2.CV_32F, np.ones(1, np.float32), taps, borderType=cv2.BORDER_REPLICATE)
    rounding, unit = np.float64(1 << (ROUND_BITS - 1)), np.float64(1 << ROUND_BITS)
    return np.floor((total.astype(np.float64) + rounding) / unit)


def _horizontal(rows: npt.NDArray[np.float64], half: Coefs) -> npt.NDArray[np.float64]:
    taps = np.array([*half[:0:-1], *half], dtype=np.float64)
    out = cv2.sepFilter2D(rows, cv2.CV_64F, taps, np.ones(1), borderType=cv2.BORDER_REPLICATE)
    return np.asarray(out, dtype=np.float64)


def _full_sum(half: npt.NDArray[np.float64]) -> float:
    return float(half[0] + 2 * half[1:].sum())


def _to_integers(half: npt.NDArray[np.float64], total: int) -> Coefs:
    """Round so that the whole symmetric kernel sums to exactly `total`: taps beside the centre keep their rounding."""
    taps = np.rint(half[1:]).astype(int)
    while 2 * taps[taps > 0].sum() > ONE:
        taps[np.argmax(taps)] -= 1
    return (int(total - 2 * taps.sum()), *(int(t) for t in taps))
