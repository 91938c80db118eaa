# SPDX-License-Identifier: Apache-2.0
"""Measurements: where a window of one picture lies in another. The only layer that uses the Board.

A `Measurer` turns frames into `View`s (sign planes kept on the board) and answers `Query`s with `Measurement`s, each
validated by itself: score of the peak, margin over the runner-up, position of the peak inside the search, texture of
the window, and a backward search that must return to the start (`validity`). Applications see views and measurements;
slots and jobs are hidden in this module, bits and their peaks in `peak`.

Pixels are those of the frames given to `view`; x to the right, y down.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from golden.correlate import Job, Status
from signum.boards.board import Board, BoardError, run_jobs
from signum.common.arrays import Image
from signum.measure.peak import Peak, locate_peaks
from signum.measure.subpixel import PeakFit
from signum.measure.validity import Reason, Rules, judge_peak


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

    `frame_size` is (width, height), pixels.
    """

    frame_size: tuple[int, int]
    _slot: int
    _owner: Measurer = field(repr=False)
    _texture: dict[tuple[int, int, int, int], float] = field(default_factory=dict, repr=False)


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
        return View(self.size, self._free.pop(0), self)

    def pair(self, left: Image, right: Image) -> tuple[View, View]:
        """Capture two frames at the same time through cameras 0 and 1; otherwise as `view`."""
        board = self._own_board()
        if len(self._free) < 2:
            raise RuntimeError("a pair needs two free slots: release some views first")
        slots = self._free[0], self._free[1]
        board.capture_pair(slots, (left, right))
        del self._free[:2]
        return View(self.size, slots[0], self), View(self.size, slots[1], self)

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
        self._own_board()
        self._check_own(*(view for q in queries for view in (q.reference, q.live)))
        rules = rules or self.rules
        answers = [Measurement(0.0, 0.0, 0.0, 0.0, False, Reason.OUTSIDE)] * len(queries)
        jobs = [(i, job) for i, q in enumerate(queries) if (job := _search(q)) is not None]
        found = self._peaks([job for _, job in jobs], rules.fit)
        passed: list[int] = []
        for (i, _), peak in zip(jobs, found, strict=True):
            reason = judge_peak(peak, rules)
            answers[i] = Measurement(peak.dx, peak.dy, peak.score, peak.margin, reason is Reason.NONE, reason,
                                     peak.above_chance)
            if answers[i].valid:
                passed.append(i)
        if rules.texture and passed:
            likeness = self._likeness([queries[i] for i in passed])
            for i, value in zip(passed, likeness, strict=True):
                if value > rules.max_likeness:
                    answers[i] = _refuse(answers[i], Reason.TEXTURE)
            passed = [i for i in passed if answers[i].valid]
        if rules.backward and passed:
            back = [_backward(queries[i], answers[i]) for i in passed]
            for i, miss in zip(passed, self._misses(back, [answers[i] for i in passed], rules), strict=True):
                if miss > rules.max_return_px:
                    answers[i] = _refuse(answers[i], Reason.RETURN)
        return answers

    def likeness(self, view: View, windows: Iterable[tuple[int, int, int, int]]) -> list[float]:
        """How much windows (x, y of the centre, width, height) look like themselves two pixels or more away.

        0 is white texture under this filter, 1 a window without texture or along a bare edge; see `Rules.max_likeness`.

        Raises:
            ValueError: if another measurer took the view.
            BoardError: if the board was configured again.
        """
        self._check_own(view)
        return self._likeness([Query(view, view, x, y, w, h) for x, y, w, h in windows])

    def _likeness(self, queries: Sequence[Query]) -> list[float]:
        wanted = {}
        reach = max(3, round(3 * self.sigma))
        for q in queries:
            key = (q.x, q.y, q.width, q.height)
            if key not in q.reference._texture:
                wanted[id(q.reference), key] = Query(q.reference, q.reference, *key, reach=(reach, reach))
        checks = [(q, job) for q in wanted.values() if (job := _search(q)) is not None]
        base = white_match(2.0, self.sigma)
        results = run_jobs(self._own_board(), [job for _, job in checks])
        for (q, job), result in zip(checks, results, strict=True):
            match = result.runner_up / (job.width * job.height) if result.status is Status.OK else 1.0
            q.reference._texture[q.x, q.y, q.width, q.height] = (match - base) / (1 - base)
        return [q.reference._texture.get((q.x, q.y, q.width, q.height), 1.0) for q in queries]

    def _misses(self, queries: Sequence[Query], forward: Sequence[Measurement], rules: Rules) -> list[float]:
        """Distance between the end of each backward query and the start of its forward one, pixels; infinite where the
        backward query has no answer."""
        misses = [float("inf")] * len(queries)
        jobs = [(i, job) for i, q in enumerate(queries) if (job := _search(q)) is not None]
        for (i, _), peak in zip(jobs, self._peaks([job for _, job in jobs], rules.fit), strict=True):
            if peak.status is Status.OK:
                misses[i] = float(np.hypot(peak.dx + forward[i].dx_px, peak.dy + forward[i].dy_px))
        return misses

    def _peaks(self, jobs: Sequence[Job], fit: PeakFit) -> list[Peak]:
        return locate_peaks(jobs, run_jobs(self._own_board(), jobs), self.sigma, fit)

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


def _refuse(m: Measurement, reason: Reason) -> Measurement:
    return replace(m, valid=False, reason=reason)


def _search(q: Query) -> Job | None:
    """The job that answers a query, its search range clipped to the picture; None where nothing is left of it."""
    width, height = q.live.frame_size
    left, top = q.x - q.width // 2, q.y - q.height // 2
    if left < 0 or top < 0 or left + q.width > q.reference.frame_size[0] or top + q.height > q.reference.frame_size[1]:
        return None
    dx, dy = round(q.guess[0]), round(q.guess[1])
    x0, x1 = max(left + dx - q.reach[0], 0), min(left + dx + q.reach[0], width - q.width)
    y0, y1 = max(top + dy - q.reach[1], 0), min(top + dy + q.reach[1], height - q.height)
    if x0 > x1 or y0 > y1:
        return None
    return Job(q.reference._slot, left, top, q.width, q.height, q.live._slot, x0, y0, x1 - x0 + 1, y1 - y0 + 1)


def _backward(q: Query, m: Measurement) -> Query:
    """The query from the place found back to the start, with the search range of the forward one."""
    dx, dy = round(m.dx_px), round(m.dy_px)
    return Query(q.live, q.reference, q.x + dx, q.y + dy, q.width, q.height, (-dx, -dy), q.reach)
