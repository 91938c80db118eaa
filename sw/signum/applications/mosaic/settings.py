# SPDX-License-Identifier: Apache-2.0
"""How a survey is made."""

from __future__ import annotations

from dataclasses import dataclass

from signum.applications.mosaic.graph import ROBUST


@dataclass(frozen=True)
class SurveySettings:
    """How a survey is made.

    Attributes:
        step: share of the frame's width or height by which a stream's view moves before a frame is stored.
        turn_deg: rotation at which it is stored all the same.
        back: number of stored frames a new one is tried against before a new component begins.
        patience: consecutive frames of a stream that may be refused before a new component begins.
        reach: pixels of the board searched around a stream's predicted place.
        loops: whether edges beside the sequence are looked for; without them the mosaic is a chain.
        overlap: least predicted overlap at which an edge is proposed, share of a frame.
        apart: least distance of two frames that both have edges to a third, share of the frame's shorter side.
        proposals: most edges proposed for a frame.
        agreed: least number of windows that must agree on a proposed edge.
        odds: least decimal logarithm of the odds that it is no chance, by its windows and by its place.
        gate: standard deviations of the prediction within which it is searched for.
        relief: share of the frame's longer side by which relief displaces what is seen, standard deviation.
        outvoted: misfit at which an edge has a quarter of its weight, in units of the usual misfit.
        farthest: largest reach, pixels of the board, searched around a prediction; beyond it the whole frame is
            searched.
        joins: frames of other components tried for each stored frame.
    """

    step: float = 1 / 3
    turn_deg: float = 5.0
    back: int = 3
    patience: int = 15
    reach: int = 24
    loops: bool = True
    overlap: float = 0.15
    apart: float = 0.1
    proposals: int = 8
    agreed: int = 5
    odds: float = 3.0
    gate: float = 4.0
    relief: float = 0.02
    outvoted: float = ROBUST
    farthest: int = 64
    joins: int = 6

    @property
    def columns(self) -> str:
        """These settings in a word: single, auto or turned."""
        return ("auto" if self.outvoted == ROBUST else "turned") if self.loops else "single"


CURVED = SurveySettings(relief=0.08, outvoted=9.0)
"""For a camera that turns in place. Its mosaic is a sphere drawn flat, on which no loop closes; the misclosure of each
loop is spread over all edges. With the default settings the mosaic would be flat in parts and torn between them."""
