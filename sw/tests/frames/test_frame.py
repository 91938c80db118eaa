# SPDX-License-Identifier: Apache-2.0
"""Pictures as they are read from files."""

from pathlib import Path

import numpy as np

from signum.common.files import write_picture
from signum.frames.frame import read_picture


def _picture(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (48, 64), dtype=np.uint8)


def test_colour_transparency_and_grey(tmp_path: Path) -> None:
    colour = np.dstack([_picture(seed=s) for s in range(3)])
    for name, picture, shape in (("c", colour, (48, 64, 3)), ("g", _picture(), (48, 64)),
                                 ("a", np.dstack([colour, _picture()]), (48, 64, 3))):
        write_picture(tmp_path / f"{name}.png", picture)
        read = read_picture(tmp_path / f"{name}.png")
        assert read.shape == shape and np.array_equal(read, picture[..., :3] if picture.ndim == 3 else picture)
