# SPDX-License-Identifier: Apache-2.0
"""Measurements: where a window of one picture lies in another. The only layer that uses the Board.

A `Measurer` turns frames into `View`s (sign planes kept on the board) and answers `Query`s with `Measurement`s, each
validated by itself: score of the peak, margin over the runner-up, position of the peak inside the search, texture of
the window, and a backward search that must return to the start (`validity`). Applications see views and measurements;
slots and jobs are hidden in this module and in `batch`.

Pixels are those of the frames given to `view`; x to the right, y down.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from golden.correlate import Status
from golden.dense import DensePass
from golden.dense_job import DenseJob, DenseResult
from signum.boards.board import Board, BoardError, run_table
from signum.common.arrays import Floats, Image
from signum.measure.batch import Peaks, Searches
from signum.measure.subpixel import PeakFit
from signum.measure.validity import PASSED, REASONS, Answers, Reason, Rules, judge_peaks


@dataclass(frozen=True)
class Measurement:
    """Displacement of a window from its reference view to another one.

    `score` is the matching fraction at the peak (0..1, chance 0.5), `margin` its difference from the best match outside
    the peak's 3x3 neighbourhood. `above_chance` is by how many standard deviations of a chance score the peak exceeds a
    chance match: a search that saw nothing but chance reaches 2 to 4, see `golden.correlate.above_chance`; 0 where
    nothing was searched. An invalid measurement has a displacement, too, which is zero where no peak was found.
    """

    dx_px: float
    dy_px: float
    score: float
    margin: float
    valid: bool
    reason: Reason = Reason.NONE
    above_chance: float = 0.0


@dataclass(frozen=True, eq=False)
class View:
    """A frame's sign plane on the board, to be used with the `Measurer` that took it until it is released.

    `frame_size` is (width, height), pixels; `picture` is the frame as it was handed over, not a copy.
    """

    frame_size: tuple[int, int]
    picture: Image = field(repr=False)
    _slot: int
    _owner: Measurer = field(repr=False)
    _texture: dict[tuple[int, ...], float] = field(default_factory=dict, repr=False)


@dataclass(frozen=True)
class Query:
    """Where does the window of `reference` with its centre at (x, y) lie in `live`?

    The window covers columns x - width//2 to x - width//2 + width - 1, and rows y - height//2 to
    y - height//2 + height - 1. The search range is `reach`
    (across, down) pixels around the `guess`ed displacement (dx, dy), clipped to the picture.
    """

    reference: View
    live: View
    x: int
    y: int
    width: int
    height: int
    guess: tuple[float, float] = (0.0, 0.0)
    reach: tuple[int, int] = (16, 16)


Window = tuple[View, tuple[int, ...]]
"""A window of a view: x and y of its centre, width, height; and 1 or 0, whether it is searched for across and down."""


class Measurer:
    """Takes views and measures between them on one board, at one picture size and sigma.

    A measurer configures the board when it is made and uses all of its slots. From the next `configure` on, that of a
    later measurer included, it raises BoardError for everything but `release`. Code that changes between two picture
    sizes makes a new measurer each time.

    Raises:
        BoardError: if the board cannot take pictures of this size, or this sigma.
    """

    def __init__(self, board: Board, size: tuple[int, int], sigma: float = 2.5, rules: Rules | None = None) -> None:
        self._board = board
        self.size = size
        self.sigma = sigma
        self.rules = rules or Rules()
        board.configure(size, sigma)
        self._configuration = board.configurations
        self._free = list(range(board.config.slots))

    @property
    def free_views(self) -> int:
        """Views that can be taken before one must be released."""
        return len(self._free)

    @property
    def window_range(self) -> tuple[int, int]:
        """Smallest and largest width and height of a window."""
        return self._board.config.min_window, self._board.config.max_window

    @property
    def dense_windows(self) -> tuple[int, ...]:
        """Sides of the windows that `dense` takes, pixels, the largest first; none on a board without the engine."""
        return self._board.config.dense_windows

    @property
    def dense_offsets(self) -> int:
        """Most offsets of one pass of `dense`."""
        return self._board.config.dense_offsets

    def view(self, frame: Image, camera: int = 0) -> View:
        """Capture a frame.

        Args:
            frame: uint8 (height, width) of the measurer's size.
            camera: which camera input it goes through.

        Raises:
            RuntimeError: if every slot is taken by views not yet released.
            BoardError: for a frame of another shape or type, or if the board was configured again.
        """
        board = self._own_board()
        if not self._free:
            raise RuntimeError(f"all {board.config.slots} slots hold views: release one first")
        board.capture(self._free[0], frame, camera)
        return View(self.size, frame, self._free.pop(0), self)

    def pair(self, left: Image, right: Image) -> tuple[View, View]:
        """Capture two frames at the same time through cameras 0 and 1; otherwise as `view`."""
        board = self._own_board()
        if len(self._free) < 2:
            raise RuntimeError("a pair needs two free slots: release some views first")
        slots = self._free[0], self._free[1]
        board.capture_pair(slots, (left, right))
        del self._free[:2]
        return View(self.size, left, slots[0], self), View(self.size, right, slots[1], self)

    def release(self, view: View) -> None:
        """Give a view's slot back; the view must not be used any more."""
        if view._slot in self._free:
            raise ValueError("this view has been released before")
        self._free.append(view._slot)

    def signs(self, view: View) -> Image:
        """The view's sign plane, uint8 (height, width) of 0 and 1: for pictures, not for measuring.

        Raises:
            ValueError: if another measurer took the view.
            BoardError: if the board was configured again.
        """
        self._check_own(view)
        return self._own_board().read_plane(view._slot)

    def measure(self, queries: Sequence[Query], rules: Rules | None = None) -> list[Measurement]:
        """Answer queries, in order; the board gets them as one batch, and the checks as a second.

        Args:
            queries: any number, of any mix of views, windows and searches.
            rules: overrides the measurer's own.

        Raises:
            ValueError: if another measurer took one of the views.
            BoardError: if the board was configured again.
        """
        self._check_own(*(view for q in queries for view in (q.reference, q.live)))
        found = self._answers(_searches(queries), [q.reference for q in queries], rules)
        values = np.stack([found.dx, found.dy, found.score, found.margin, found.above_chance], axis=1).tolist()
        return [Measurement(dx, dy, score, margin, reason == PASSED, REASONS[reason], chance)
                for (dx, dy, score, margin, chance), reason in zip(values, found.reasons.tolist(), strict=True)]

    def measure_windows(self, reference: View, live: View, centres: NDArray[np.int64], size: tuple[int, int],
                        guess: tuple[float, float] | Floats, reach: tuple[int, int], rules: Rules | None = None
                        ) -> Answers:
        """Answer the queries for many windows of one view in one other, as `measure`, without an object for each.

        Args:
            reference: the windows' view.
            live: the view that is searched.
            centres: (n, 2) of the windows, as those of `Query`.
            size: width and height of the windows.
            guess: expected displacement, of all or, (n, 2), of each.
            reach: search range around it.
            rules: overrides the measurer's own.

        Raises:
            ValueError: if another measurer took one of the views.
            BoardError: if the board was configured again.
        """
        self._check_own(reference, live)
        count = len(centres)
        rest = np.tile([reference._slot, live._slot, *size, *reach], (count, 1))
        whole = np.hstack([rest[:, :2], centres, rest[:, 2:]])
        return self._answers(Searches.of(whole, np.broadcast_to(np.asarray(guess, np.float64), (count, 2))),
                             [reference] * count, rules)

    def _answers(self, searches: Searches, references: Sequence[View], rules: Rules | None) -> Answers:
        """The answers of searches for windows of these views, one each."""
        rules = rules or self.rules
        which, peaks = self._peaks(searches, rules.fit)
        reasons = np.full(len(references), REASONS.index(Reason.OUTSIDE))
        reasons[which] = judge_peaks(peaks, rules)
        values = np.zeros((5, len(references)))
        values[:, which] = peaks.dx, peaks.dy, peaks.score, peaks.margin, peaks.above_chance
        if rules.texture:
            passed = np.flatnonzero(reasons == PASSED)
            windows = zip(passed.tolist(), searches.some(passed).windows, strict=True)
            likeness = self._likeness([(references[i], window) for i, window in windows])
            reasons[passed[likeness > rules.max_likeness]] = REASONS.index(Reason.TEXTURE)
        if rules.backward:
            passed = np.flatnonzero(reasons == PASSED)
            miss = self._misses(searches.some(passed), values[:2, passed].T, rules)
            reasons[passed[miss > rules.max_return_px]] = REASONS.index(Reason.RETURN)
        dx, dy, score, margin, chance = values
        return Answers(dx, dy, score, margin, chance, reasons)

    def dense(self, left: View, right: View, search: DensePass, step: tuple[int, int] = (1, 1)) -> DenseResult:
        """Run a pass of the dense engine between two views: the bits of the board, which nothing validates.

        Args:
            left: view whose pixels the answer has.
            right: view that is searched.
            search: the pass.
            step: pixels from one answered pixel to the next, across and down.

        Raises:
            ValueError: if another measurer took one of the views.
            BoardError: if the board has no dense engine, refuses the pass, or was configured again.
        """
        self._check_own(left, right)
        return self._own_board().dense(DenseJob(left._slot, right._slot, search, step))

    def likeness(self, view: View, windows: Iterable[tuple[int, int, int, int]]) -> list[float]:
        """How much windows (x, y of the centre, width, height) look like themselves two pixels or more away.

        0 is white texture under this filter, 1 a window without texture or along a bare edge; see `Rules.max_likeness`.

        Raises:
            ValueError: if another measurer took the view.
            BoardError: if the board was configured again.
        """
        self._check_own(view)
        return list(map(float, self._likeness([(view, (*window, 1, 1)) for window in windows])))

    def _likeness(self, windows: Sequence[Window]) -> Floats:
        """As `likeness`, of windows of any views, in the directions that they are searched in; a view keeps what was
        measured. A window that is searched for along its row only may well look like itself above and below."""
        wanted = list({(view, key): None for view, key in windows if key not in view._texture})
        if wanted:
            reach = max(3, round(3 * self.sigma))
            whole = np.array([(view._slot, view._slot, *key) for view, key in wanted], np.int64)
            whole[:, 6:] *= reach
            jobs, which = Searches.of(whole, np.zeros((len(whole), 2))).jobs(self.size)
            results = run_table(self._own_board(), jobs)
            match = np.ones(len(whole))
            match[which] = np.where(results[:, 0] == Status.OK, results[:, -1] / (jobs[:, 3] * jobs[:, 4]), 1.0)
            base = white_match(2.0, self.sigma)
            for (view, key), value in zip(wanted, ((match - base) / (1 - base)).tolist(), strict=True):
                view._texture[key] = value
        return np.array([view._texture[key] for view, key in windows], np.float64)

    def _misses(self, forward: Searches, moved: Floats, rules: Rules) -> Floats:
        """Distance between the end of each search back from where `forward` moved to and its start, pixels; infinite
        where there is nothing to search."""
        which, back = self._peaks(forward.back(moved), rules.fit)
        miss = np.full(len(moved), np.inf)
        far = np.hypot(back.dx + moved[which, 0], back.dy + moved[which, 1])
        miss[which] = np.where(back.status == Status.OK, far, np.inf)
        return miss

    def _peaks(self, searches: Searches, fit: PeakFit) -> tuple[NDArray[np.intp], Peaks]:
        """The peaks of the searches that have something to search, and the numbers of these."""
        jobs, which = searches.jobs(self.size)
        return which, Peaks.of(jobs, run_table(self._own_board(), jobs), self.sigma, fit)

    def _own_board(self) -> Board:
        """The board, as this measurer configured it."""
        if self._board.configurations != self._configuration:
            raise BoardError("the board was configured again, by another Measurer or by hand, and no longer holds this "
                             "Measurer's views: make a new Measurer, or open a second board")
        return self._board

    def _check_own(self, *views: View) -> None:
        if any(view._owner is not self for view in views):
            raise ValueError("the view was taken by another Measurer: take it again with this one")


def white_match(distance: float, sigma: float) -> float:
    """Matching fraction of white texture's signs with themselves, shifted by `distance` pixels."""
    x = distance**2 / (4 * sigma**2)
    rho = np.exp(-x) * (1 - 2 * x + x**2 / 2)
    return float(0.5 + np.arcsin(rho) / np.pi)


def _searches(queries: Sequence[Query]) -> Searches:
    whole = [(q.reference._slot, q.live._slot, q.x, q.y, q.width, q.height, *q.reach) for q in queries]
    return Searches.of(np.array(whole, np.int64).reshape(-1, 8),
                       np.array([q.guess for q in queries], np.float64).reshape(-1, 2))
