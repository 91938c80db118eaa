# SPDX-License-Identifier: Apache-2.0
"""Board configurations: one validated dataclass from which every width is derived.

`python -m golden.params` writes `rtl/gen/<name>/slog_cfg_pkg.sv` for each named configuration;
`python -m golden.params --check` fails when a committed package is stale.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

PIXEL_BITS = 8
"""Bits of an unsigned grey sample."""
COEF_BITS = 18
"""Bits of a signed LoG coefficient; 1.0 is 2**COEF_FRACTION."""
COEF_FRACTION = 15
"""Fraction bits of a LoG coefficient."""
TAG_BITS = 16
"""Bits of a job's tag."""
SCORE_BITS = 15
"""Bits of a score in a result, in every configuration: 0..16384."""
NO_SCORE = (1 << SCORE_BITS) - 1
"""Absent score: no offset at that position, or none outside the neighbourhood of the peak."""
MIN_SIGMA, MAX_SIGMA = 1.0, 4.0
"""Range of sigma that every board takes, pixels: within it the sign agrees with a float64 LoG and the kernel fits."""


@dataclass(frozen=True)
class Config:
    """A board build. Lengths in pixels, depths in entries.

    `group_bits` is the width of one operand group of the correlator array and of a store word; an array
    step takes two rows of a window up to `group_bits` wide, or one row of a window up to `max_window` wide.
    Without `array` it has none, and takes no jobs.

    A board with `dense_offsets` has a dense engine of as many offsets, 0 for none, in groups of `dense_lanes`; its
    windows are `dense_window` wide and `dense_sizes` - 1 times half as wide.

    Raises:
        ValueError: if the numbers contradict one another.
    """

    name: str
    max_width: int
    max_height: int
    min_window: int
    group_bits: int
    radius: int
    cameras: int = 2
    slots: int = 6
    job_depth: int = 64
    result_depth: int = 64
    surface_depth: int = 1024
    array: bool = True
    dense_offsets: int = 0
    dense_window: int = 32
    dense_sizes: int = 3
    dense_lanes: int = 8

    def __post_init__(self) -> None:
        if self.group_bits < 4 or self.group_bits & (self.group_bits - 1):
            raise ValueError("group_bits must be a power of two, 4 or more")
        if not 1 <= self.min_window <= self.group_bits:
            raise ValueError("min_window must lie in 1..group_bits")
        if min(self.max_width, self.max_height) < max(self.max_window, self.min_image):
            raise ValueError("the image must hold the largest window and the LoG kernel")
        if not 1 <= self.cameras <= 2 or not 2 <= self.slots <= 8:
            raise ValueError("cameras must be 1..2 and slots 2..8")
        if self.max_width >= 1024 or self.max_height >= 1024:
            raise ValueError("coordinates have 10 bits")
        if self.radius < 2 * MAX_SIGMA:
            raise ValueError(f"radius must be {2 * MAX_SIGMA:g} or more, to hold a LoG of sigma {MAX_SIGMA:g}")
        self._check_dense()

    def _check_dense(self) -> None:
        if not (self.array or self.dense_offsets):
            raise ValueError("a board needs the array or a dense engine")
        if self.dense_lanes < 1 or self.dense_offsets % self.dense_lanes or not 0 <= self.dense_offsets <= 256:
            raise ValueError("dense_offsets must be a multiple of dense_lanes, 256 or less")
        if self.dense_window not in (2, 4, 8, 16, 32) or not 1 <= self.dense_sizes < self.dense_window.bit_length():
            raise ValueError("dense_window must be a power of two, 2 to 32, and its smallest part 2 or more")

    @property
    def max_window(self) -> int:
        """Largest window width and height."""
        return 2 * self.group_bits

    @property
    def pitch(self) -> int:
        """Horizontal offsets from one array pass to the next."""
        return self.group_bits // 2

    @property
    def lanes(self) -> int:
        """Horizontal offsets one pass can score; the last pass of a row may be one wider than the pitch."""
        return self.pitch + 1

    @property
    def min_image(self) -> int:
        """Smallest image width and height: the LoG kernel plus one."""
        return 2 * self.radius + 2

    @property
    def words_per_row(self) -> int:
        """Store words a row occupies, whatever the image width."""
        return -(-self.max_width // self.group_bits)

    @property
    def slot_words(self) -> int:
        """Store words of one slot."""
        return self.words_per_row * self.max_height

    @property
    def store_words(self) -> int:
        """Store words of all slots."""
        return self.slots * self.slot_words

    @property
    def score_bits(self) -> int:
        """Bits the array needs for a count 0..max_window**2; results always carry SCORE_BITS."""
        return (self.max_window**2).bit_length()

    @property
    def ring_rows(self) -> int:
        """Search rows the operand ring holds: a power of two, two windows high."""
        return 2 * self.max_window

    @property
    def dense_windows(self) -> tuple[int, ...]:
        """Sides of the dense engine's windows, the largest first; none without an engine."""
        return tuple(self.dense_window >> k for k in range(self.dense_sizes)) if self.dense_offsets else ()

    @property
    def coefs(self) -> int:
        """Coefficients of a symmetric kernel: centre first, then one per distance."""
        return self.radius + 1


TINY = Config(name="tiny", max_width=48, max_height=36, min_window=2, group_bits=8, radius=8,
              job_depth=8, result_depth=4, surface_depth=64)
FULL = Config(name="full", max_width=640, max_height=480, min_window=8, group_bits=64, radius=16)
DENSE = Config(name="dense", max_width=640, max_height=480, min_window=8, group_bits=64, radius=16, slots=3,
               array=False, dense_offsets=128)
TINY_DENSE = Config(name="tiny_dense", max_width=48, max_height=36, min_window=2, group_bits=8, radius=8, slots=3,
                    job_depth=8, result_depth=4, surface_depth=64, array=False, dense_offsets=16, dense_window=8,
                    dense_sizes=2)
CONFIGS = {c.name: c for c in (TINY, FULL, TINY_DENSE, DENSE)}


def sv_package(c: Config) -> str:
    """Text of `slog_cfg_pkg` for configuration `c`."""
    values = {
        "MaxWidth": c.max_width, "MaxHeight": c.max_height, "MinImage": c.min_image, "Cameras": c.cameras,
        "Slots": c.slots, "MinWindow": c.min_window, "MaxWindow": c.max_window, "GroupBits": c.group_bits,
        "Pitch": c.pitch, "Lanes": c.lanes, "ScoreBits": c.score_bits, "RingRows": c.ring_rows,
        "WordsPerRow": c.words_per_row, "SlotWords": c.slot_words, "StoreWords": c.store_words,
        "Radius": c.radius, "Coefs": c.coefs, "CoefBits": COEF_BITS, "CoefFraction": COEF_FRACTION,
        "JobDepth": c.job_depth, "ResultDepth": c.result_depth, "SurfaceDepth": c.surface_depth,
    }
    if c.dense_offsets:
        values |= {"DenseOffsets": c.dense_offsets, "DenseWindow": c.dense_window, "DenseSizes": c.dense_sizes,
                   "DenseLanes": c.dense_lanes}
    lines = [f"  localparam int unsigned {k} = {v};" for k, v in values.items()]
    return "\n".join([
        "// SPDX-License-Identifier: Apache-2.0",
        f"// Parameters of the `{c.name}` board. Generated by golden/params.py: do not edit.",
        "package slog_cfg_pkg;", *lines, "endpackage : slog_cfg_pkg", ""])


def main(argv: list[str]) -> int:
    """Write the packages, or compare them with `--check` among `argv`; returns the exit status."""
    stale = []
    for c in CONFIGS.values():
        path = ROOT / "rtl" / "gen" / c.name / "slog_cfg_pkg.sv"
        text = sv_package(c)
        if "--check" in argv:
            if not path.exists() or path.read_text() != text:
                stale.append(str(path.relative_to(ROOT)))
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    if stale:
        print(f"stale: {', '.join(stale)}; run `make regs`", file=sys.stderr)
    return bool(stale)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
