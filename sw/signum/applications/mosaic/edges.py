"""An edge of the pose graph, measured between two frames, and its row in `edges.csv`."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from signum.common.errors import SignumError
from signum.geometry.similarity import Similarity
from signum.measure.register import Registration
from signum.tables.schemas import SURVEY_EDGES

SEQUENCE = "sequence"
"""Kind of an edge to the frame stored last, or one of the few before it."""
LIVE = "live"
"""Kind of an edge to the frame stored last from a frame of a stream that is placed but not stored."""
LOOP = "loop"
"""Kind of an edge proposed from the predicted overlap."""
JOIN = "join"
"""Kind of an edge between two components."""


@dataclass(frozen=True)
class Edge:
    """Where frame b shows what frame a shows; the figures of a refused edge are for the record only.

    Attributes:
        similarity: original pixels of a -> of b.
        centre: of the frames, original pixels; `shift` of the table is measured there.
        middle, spread_px, rms_px, score, margin, agreed, tried, accepted, reason: see `Registration`.
        spread_px: 0 where rotation and scale were not measured.
    """

    frame_a: str
    frame_b: str
    kind: str
    similarity: Similarity
    centre: tuple[float, float]
    score: float = 0.0
    margin: float = 0.0
    accepted: bool = True
    middle: tuple[float, float] = (0.0, 0.0)
    spread_px: float = 0.0
    rms_px: float = 0.0
    agreed: int = 0
    tried: int = 0
    reason: str = ""

    @classmethod
    def of(cls, a: str, b: str, kind: str, centre: tuple[float, float], r: Registration, reason: str = "") -> Edge:
        """From a registration of frame `a` in frame `b`; a `reason` refuses what the registrar accepted."""
        return cls(a, b, kind, r.similarity, centre, r.score, r.margin, r.accepted and not reason, r.middle,
                   r.spread_px if r.turning else 0.0, r.rms_px, r.agreed, r.tried, reason or r.reason)

    @property
    def shift(self) -> tuple[float, float]:
        """Where a's centre lands in b, minus b's centre, pixels."""
        dx, dy = self.similarity(np.array(self.centre)) - np.array(self.centre)
        return float(dx), float(dy)

    @property
    def row(self) -> list[object]:
        """The row of the table."""
        dx, dy = self.shift
        return [self.frame_a, self.frame_b, f"{dx:.3f}", f"{dy:.3f}", f"{self.score:.4f}", f"{self.margin:.4f}",
                int(self.accepted), self.kind, f"{self.similarity.rot_deg:.5f}", f"{self.similarity.scale:.7f}",
                *(f"{v:.2f}" for v in (*self.middle, self.spread_px, self.rms_px)), self.agreed, self.tried,
                self.reason]

    @classmethod
    def read(cls, row: dict[str, str], centre: tuple[float, float]) -> Edge:
        """From a row of the table.

        Raises:
            KeyError, ValueError: if it is not one.
        """
        turn = Similarity.of(float(row["rot_deg"]), float(row["scale"]))
        middle = complex(*centre)
        shift = middle + complex(float(row["dx_px"]), float(row["dy_px"])) - turn.factor * middle
        return cls(row["frame_a"], row["frame_b"], row["kind"], Similarity(turn.factor, shift), centre,
                   float(row["score"]), float(row["margin"]), row["accepted"] == "1",
                   (float(row["middle_x_px"]), float(row["middle_y_px"])), float(row["spread_px"]),
                   float(row["rms_px"]), int(row["agreed"]), int(row["tried"]), row["reason"])


def read_edges(path: Path, centre: tuple[float, float]) -> list[Edge]:
    """The rows of a survey's `edges.csv`; a last row cut short by a crash is left out.

    Raises:
        SignumError: if the file is not such a table.
    """
    with path.open(newline="", encoding="utf-8") as file:
        text = file.read()
    whole = text[: text.rfind("\n") + 1]
    rows = csv.DictReader(whole.splitlines())
    if tuple(rows.fieldnames or ()) != SURVEY_EDGES:
        raise SignumError(f"{path}: not the edges of a survey; start anew without --resume")
    try:
        return [Edge.read(row, centre) for row in rows]
    except (KeyError, ValueError, TypeError) as error:
        raise SignumError(f"{path}: a row cannot be read; start anew without --resume") from error
