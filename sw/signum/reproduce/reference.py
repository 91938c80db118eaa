# SPDX-License-Identifier: Apache-2.0
"""Real surveys with references beside them: SIFT pairs, georeferenced centres (see `../shared/data/README.md`)."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from signum.common.arrays import Floats
from signum.geometry.similarity import Similarity

SHARED = Path(__file__).resolve().parents[4] / "shared" / "data"
"""Where the development frames are, if they are on this machine; nothing needs them."""


@dataclass(frozen=True)
class Pair:
    """A reference: pixels of frame a -> of frame b, and the number of feature matches behind it."""

    similarity: Similarity
    inliers: int


def read_pairs(path: Path) -> dict[tuple[str, str], Pair]:
    """The pairs of a `sift_pairs.csv`, by (frame a, frame b)."""
    with path.open(newline="", encoding="utf-8") as file:
        return {(row["frame_a"], row["frame_b"]): Pair(
            Similarity.of(float(row["rot_deg"]), float(row["scale"]), (float(row["tx_px"]), float(row["ty_px"]))),
            int(row["inliers"])) for row in csv.DictReader(file)}


def residuals(places: Mapping[str, Similarity], pairs: Mapping[tuple[str, str], Pair],
              size: tuple[int, int]) -> Floats:
    """How far poses are from each pair, pixels of b: the mean over the quarter points of a's frame, (pairs,).

    Args:
        places: pixels of each frame -> mosaic plane, all frames of the pairs.
        pairs: references.
        size: width and height of the frames, pixels.
    """
    points = np.array([[x * (size[0] - 1), y * (size[1] - 1)] for x in (0.25, 0.75) for y in (0.25, 0.75)])
    out = []
    for (a, b), pair in pairs.items():
        off = (places[b].inverse @ places[a])(points) - pair.similarity(points)
        out.append(float(np.hypot(off[:, 0], off[:, 1]).mean()))
    return np.array(out)
