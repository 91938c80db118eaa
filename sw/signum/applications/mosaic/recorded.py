# SPDX-License-Identifier: Apache-2.0
"""A survey of which all frames are there: its pairs are measured by many at a time, the graph is solved in between.

    1. every frame is stored, and registered against the one before; where that is refused, against the one before that
    2. in rounds: the pairs that the poses predict well enough to search near their place, all at once; then the graph
    3. pairs that are predicted less well, one round; then as before, until there are none
    4. frames of different components, one round; those that an edge joins go on with 2

Early rounds link columns near their turns, where the poses are known well, and later ones the rest, as a zipper closes.
Which pairs are measured depends on what was measured before, but never on who measured it and in what order: a round's
questions are put together first, answered into the journal, and only then taken in, in their order.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from signum.applications.mosaic.crew import Crew, shared_out
from signum.applications.mosaic.ledger import Piece
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.survey import Survey
from signum.common.errors import SignumError
from signum.frames.frame import Frame
from signum.geometry.similarity import Similarity
from signum.measure.register import Registrar

BATCH = "batch"
"""The `order` of such a survey in its record."""
ROUNDS = 60
"""Most rounds of a component."""
AGAIN = 3
"""Times that pairs are tried again whose prediction has changed."""
Question = tuple[str, str, Similarity | None, int | None]
"""Names of two frames, guess and reach of the search for the first in the second."""


class RecordedSurvey(Survey):
    """Stores frames as they are added, and measures in `finish`; for snapshots.

    Args:
        crew: who measures; by default this process.
        registrar, out, settings, source, resume, calibration: see `Survey`.
    """

    def __init__(self, registrar: Registrar, out: Path, settings: SurveySettings | None = None, source: str = "",
                 resume: bool = False, calibration: str = "", crew: Crew | None = None) -> None:
        super().__init__(registrar, out, False, settings, source, resume, math.inf, calibration, BATCH)
        self.crew = crew
        self._names: list[str] = []

    def _take(self, frame: Frame) -> str:
        self._keep(frame)
        self._names.append(frame.name)
        return f"{frame.name}: stored"

    def finish(self) -> Iterator[str]:
        """Measure everything; yields a phrase now and then. Those who measure are let go at the end.

        Raises:
            SignumError: if those who measure are lost.
        """
        yield from self._measure()
        if self.crew is not None:
            self.crew.close()

    def _measure(self) -> Iterator[str]:
        """The whole of it."""
        if self._names and not self.ledger.opened:
            self.open_table()
        yield from self._follow()
        if not self.settings.loops:
            return
        for piece in self.pieces:
            yield from self._close_loops(piece)
        while len(self.pieces) > 1:
            joined: list[Piece] = []
            yield from self._join(joined)
            if not joined:
                return
            for piece in joined:
                if piece in self.pieces:
                    yield from self._close_loops(piece)

    def _follow(self) -> Iterator[str]:
        """Chain the frames: each to one of the few before it, or a component begins."""
        number, open_ones = {name: k for k, name in enumerate(self._names)}, self._names[1:]
        for lag in range(1, self.settings.back + 1):
            pairs = [(self._names[number[name] - lag], name) for name in open_ones if number[name] >= lag]
            yield from self._ask([(*pair, None, None) for pair in pairs], "neighbours")
            open_ones = [b for a, b in pairs if not self.ledger.register(a, b).accepted]
        for name in self._names:
            edge = self._linked(name) if self.pieces else None
            if edge is None:
                self.ledger.begin(name)
            else:
                self._enter(edge)
        for piece in self.pieces:
            yield f"{len(piece.stored)} frames placed"
            self.ledger.solve(piece)

    def _close_loops(self, piece: Piece) -> Iterator[str]:
        """Rounds of a component, until its poses predict no more pairs."""
        again = 0
        for turn in range(1, ROUNDS + 1):
            chosen = []
            for name in list(piece.stored):
                chosen += [one for one in self._loops.choose(piece, name) if one[0][1] == name]
                yield f"round {turn}: {len(chosen)} pairs"
            near = [one for one in chosen if self._search(piece, *one)[2] is not None]
            chosen = near or chosen
            if not chosen:
                again += 1
                if again > AGAIN or not self._loops.forget(piece):
                    break
                continue
            yield from self._ask([self._search(piece, *one) for one in chosen], f"round {turn}")
            for pair, deviation in chosen:
                self._loops.attempt(piece, pair, deviation)
            self.ledger.solve(piece)
        self._loops.conclude(piece)

    def _search(self, piece: Piece, pair: tuple[str, str], deviation: float) -> Question:
        """The question about a proposed pair."""
        predicted = piece.places[pair[1]].inverse @ piece.places[pair[0]]
        return *pair, *self._loops.search(predicted, deviation)

    def _join(self, joined: list[Piece]) -> Iterator[str]:
        """Look for edges from the smaller components to the others; those that were joined are added to `joined`."""
        main = self.ledger.ranked()[0]
        small = [piece for piece in self.pieces if piece is not main]
        pairs = [(other, name) for piece in small for name in piece.stored for other in self._loops.beside(name)]
        yield from self._ask([(*pair, None, None) for pair in pairs if pair not in self._loops.tried], "components")
        for piece in small:
            for name in list(piece.stored):
                if len(self.pieces) > 1 and self.ledger.piece_of(name) is piece and self._loops.join(name):
                    joined.append(self.ledger.piece_of(name))
                    break
                yield f"components: {name}"

    def _ask(self, questions: Sequence[Question], what: str) -> Iterator[str]:
        """Have questions answered into the journal; yields a phrase for each share of them."""
        journal, ledger = self.ledger.shelf.journal, self.ledger
        keys = {ledger.key(*question): question for question in questions}
        missing = [key for key in keys if journal.find(key) is None]
        done = 0
        if self.crew is None:
            for done, key in enumerate(missing, 1):
                ledger.register(*keys[key])
                yield f"{what}: {done} of {len(missing)} pairs"
            return
        for share, found in self.crew.answers(shared_out(missing, self.crew.size)):
            for key, one in zip(share, found, strict=True):
                journal.pair(key, one)
            if share:
                journal.sync()
            done += len(share)
            yield f"{what}: {done} of {len(missing)} pairs"


def check_batch(stream: bool, live: bool, label: str) -> None:
    """Check that a source can be measured in a batch.

    Raises:
        SignumError: if its frames are not all there, or are a stream's, of which each is placed by the one before.
    """
    if stream or live:
        raise SignumError(f"{label}: --batch is for snapshots, a folder of pictures: the frames of a video or stream "
                          "are placed one after the other; leave --batch away, or give a folder of stills from it")

