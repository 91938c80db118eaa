# SPDX-License-Identifier: Apache-2.0
"""Makes the pictures of the page on the idea from the project's own code: `python docs/tools/pictures.py`."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np

from golden.log import sign
from signum.common.arrays import Image
from signum.common.files import write_picture
from signum.world.degrade import degrade
from signum.world.seafloor import photograph

ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / "docs" / "img"
SIGMA, GAP = 1.5, 8


def signs() -> Image:
    """A photograph and the same in bad water, side by side, over their signs; uint8 (488, 648)."""
    clear = np.ascontiguousarray(photograph("gravel")[120:360, 100:420])
    columns = [np.vstack([view, np.full((GAP, view.shape[1]), 255, np.uint8), sign(view, SIGMA) * np.uint8(255)])
               for view in (clear, degrade(clear))]
    return np.hstack([columns[0], np.full((columns[0].shape[0], GAP), 255, np.uint8), columns[1]])


def main() -> None:
    """Write the pictures."""
    write_picture(IMAGES / "signs.png", signs(), 9)
    spec = importlib.util.spec_from_file_location("surface", ROOT / "examples" / "surface.py")
    assert spec is not None and spec.loader is not None
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    example.main(str(IMAGES / "surface.png"))


if __name__ == "__main__":
    main()
