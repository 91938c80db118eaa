# SPDX-License-Identifier: Apache-2.0
"""The frame and the signs of `tb_signs`: `python -m sim.testbench.vectors` writes them, `--check` compares them."""

from __future__ import annotations

import sys

import numpy as np

from golden.log import Image, sign
from golden.params import TINY
from sim.toolchain import ROOT, TESTBENCHES

VECTORS = TESTBENCHES / "signs"
SIGMA = 1.5


def vectors() -> dict[str, str]:
    """Texts of the files: a frame of random blocks of 3x3 pixels with noise, and the words of its signs."""
    rng = np.random.default_rng(1)
    blocks = rng.integers(0, 200, (-(-TINY.max_height // 3), -(-TINY.max_width // 3)))
    frame = np.kron(blocks, np.ones((3, 3), np.int64))[:TINY.max_height, :TINY.max_width]
    image: Image = np.asarray(frame + rng.integers(0, 50, frame.shape), np.uint8)
    plane = sign(image, SIGMA, TINY.radius)
    words = np.packbits(plane.reshape(-1, TINY.group_bits), axis=1, bitorder="little")
    return {"frame.hex": "".join(f"{' '.join(f'{p:02x}' for p in row)}\n" for row in image),
            "signs.hex": "".join(f"{' '.join(f'{w:02x}' for w in row)}\n"
                                 for row in words.reshape(TINY.max_height, -1))}


def main(argv: list[str]) -> int:
    """Write the files, or compare them; returns the exit status."""
    wrong = [name for name, text in vectors().items()
             if not (VECTORS / name).exists() or (VECTORS / name).read_text() != text]
    if "--check" in argv:
        for name in wrong:
            print(f"stale: {(VECTORS / name).relative_to(ROOT)}; run `make regs`", file=sys.stderr)
        return bool(wrong)
    VECTORS.mkdir(exist_ok=True)
    for name in wrong:
        (VECTORS / name).write_text(vectors()[name])
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
