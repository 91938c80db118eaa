# SPDX-License-Identifier: Apache-2.0
"""Types of arrays; their shapes and units are given where they are used."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]
"""Grey (height, width), colour (height, width, 3) as blue, green, red, or a sign plane (height, width) of 0 and 1."""
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
