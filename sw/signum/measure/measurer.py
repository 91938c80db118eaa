"""Measurements: where a window of one picture lies in another. The only layer that knows the Board.

A `Measurer` turns frames into `View`s (sign planes kept on the board) and answers `Query`s with `Measurement`s, each
validated by itself: peak, margin over the runner-up, position of the peak inside the search, texture of the window, and
a backward search that must return to the start. Applications see views and measurements; slots, jobs and bits stay in
here.

Pixels are those of the frames given to `view`; x to the right, y down.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from golden.correlate import Job, Result, Status
from golden.params import NO_SCORE
from signum.boards.board import Board, run_jobs
from signum.common.arrays import Image
from signum.measure.subpixel import CONE_FROM, Fit, line_offset, peak_offsets


class Reason(StrEnum):
    """Why a measurement is not valid; of several, the first in this order."""

    NONE = ""
    OUTSIDE = "outside"
    """The window, or everything it was searched for in, lies outside the picture."""
    SCORE = "score"
    """The peak is too low."""
    MARGIN = "margin"
    """Another place matches nearly as well."""
    BORDER = "border"
    """The peak lies at the border of the search: the true one may lie beyond."""
    TEXTURE = "texture"
    """The window looks like itself elsewhere: too plain, or a bare edge."""
    RETURN = "return"
    """The search from the found place back did not return to the start."""
    PARTS = "parts"
    """The window and its parts moved apart: perspective, relief, or chance."""


@dataclass(frozen=True)
class Measurement:
    """Displacement of a window from its reference view to another one.

    `score` is the matching fraction at the peak (0..1, chance 0.5), `margin` how far it stands above the best match
    outside the peak's 3x3 neighbourhood. Displacement is filled in also where the measurement is not valid, zero where
    there is none.
    """

    dx_px: float
    dy_px: float
    score: float
    margin: float
    valid: bool
    reason: Reason = Reason.NONE


@dataclass(frozen=True, eq=False)
class View:
    """A frame's sign plane on the board: a handle, good until released. `frame_size` is (width, height)."""

    frame_size: tuple[int, int]
    _slot: int
    _texture: dict[tuple[int, int, int, int], float] = field(default_factory=dict, repr=False)


@dataclass(frozen=True)
class Query:
    """Where does the window of `reference` with its centre at (x, y) lie in `live`?

    The window covers x - width//2 .. x - width//2 + width - 1. Searched are the places within `reach` (across, down)
    pixels of the `guess`ed displacement (dx, dy), as far as they lie inside the picture.
    """

    reference: View
    live: View
    x: int
    y: int
    width: int
    height: int
    guess: tuple[float, float] = (0.0, 0.0)
    reach: tuple[int, int] = (16, 16)


@dataclass(frozen=True)
class Rules:
    """What makes a measurement valid. Scores are matching fractions.

    `min_score` is not a matter of chance level alone: wrong peaks on real seabed score far above it, so the other
    checks carry the weight. `max_likeness` bounds how well a window may match itself two pixels or more away, beyond
    what white texture under the same filter does (0: exactly that, 1: identical). `max_return_px` is the distance by
    which the backward search may miss.
    """

    min_score: float = 0.62
    min_margin: float = 0.02
    max_likeness: float = 0.6
    max_return_px: float = 1.0
    backward: bool = True
    texture: bool = True
    fit: Fit = "auto"


class Measurer:
    """Takes views and measures between them on one board, at one picture size and sigma.

    Raises:
        BoardError: if the board cannot take pictures of this size, or this sigma.
    """

    def __init__(self, board: Board, size: tuple[int, int], sigma: float = 2.5, rules: Rules | None = None) -> None:
        self._board = board
        self.size = size
        self.sigma = sigma
        self.rules = rules or Rules()
        board.set_image_size(*size)
        board.set_filter(sigma)
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
            BoardError: for a frame of another shape or type.
        """
        if not self._free:
            raise RuntimeError(f"all {self._board.config.slots} slots hold views: release one first")
        self._board.capture(self._free[0], frame, camera)
        return View(self.size, self._free.pop(0))

    def pair(self, left: Image, right: Image) -> tuple[View, View]:
        """Capture two frames at the same time through cameras 0 and 1; otherwise as `view`."""
        if len(self._free) < 2:
            raise RuntimeError("a pair needs two free slots: release some views first")
        slots = self._free[0], self._free[1]
        self._board.capture_pair(slots, (left, right))
        del self._free[:2]
        return View(self.size, slots[0]), View(self.size, slots[1])

    def release(self, view: View) -> None:
        """Give a view's slot back; the view must not be used any more."""
        if view._slot in self._free:
            raise ValueError("this view has been released before")
        self._free.append(view._slot)

    def signs(self, view: View) -> Image:
        """The view's sign plane, uint8 (height, width) of 0 and 1: for pictures, not for measuring."""
        return self._board.read_plane(view._slot)

    def measure(self, queries: Sequence[Query], rules: Rules | None = None) -> list[Measurement]:
        """Answer queries, in order; the board gets them as one batch, and the checks as a second.

        Args:
            queries: any number, of any mix of views, windows and searches.
            rules: overrides the measurer's own.
        """
        rules = rules or self.rules
        answers = [Measurement(0.0, 0.0, 0.0, 0.0, False, Reason.OUTSIDE)] * len(queries)
        jobs = [(i, job) for i, q in enumerate(queries) if (job := _search(q)) is not None]
        found = self._peaks([job for _, job in jobs], rules.fit)
        passed: list[int] = []
        for (i, job), peak in zip(jobs, found, strict=True):
            answers[i] = peak.measurement(job, rules)
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
        """
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
        for (q, job), result in zip(checks, run_jobs(self._board, [job for _, job in checks]), strict=True):
            match = result.runner_up / (job.width * job.height) if result.status is Status.OK else 1.0
            q.reference._texture[q.x, q.y, q.width, q.height] = (match - base) / (1 - base)
        return [q.reference._texture.get((q.x, q.y, q.width, q.height), 1.0) for q in queries]

    def _misses(self, queries: Sequence[Query], forward: Sequence[Measurement], rules: Rules) -> list[float]:
        """Distance between where each backward query ends and where its forward one began; infinite for none."""
        misses = [float("inf")] * len(queries)
        jobs = [(i, job) for i, q in enumerate(queries) if (job := _search(q)) is not None]
        for (i, _), peak in zip(jobs, self._peaks([job for _, job in jobs], rules.fit), strict=True):
            if peak.status is Status.OK:
                misses[i] = float(np.hypot(peak.dx + forward[i].dx_px, peak.dy + forward[i].dy_px))
        return misses

    def _peaks(self, jobs: Sequence[Job], fit: Fit) -> list[_Peak]:
        return _refine(jobs, run_jobs(self._board, jobs), fit)


def white_match(distance: float, sigma: float) -> float:
    """Matching fraction of white texture's signs with themselves, shifted by `distance` pixels."""
    x = distance**2 / (4 * sigma**2)
    rho = np.exp(-x) * (1 - 2 * x + x**2 / 2)
    return float(0.5 + np.arcsin(rho) / np.pi)


@dataclass(frozen=True)
class _Peak:
    """A result in pixels: displacement, matching fractions, and whether the peak is inside its search."""

    status: Status
    dx: float = 0.0
    dy: float = 0.0
    score: float = 0.0
    margin: float = 0.0
    inside: bool = False

    def measurement(self, job: Job, rules: Rules) -> Measurement:
        """The measurement as far as one search can tell."""
        if self.status is not Status.OK:
            return Measurement(0.0, 0.0, 0.0, 0.0, False, Reason.OUTSIDE)
        checks = ((Reason.SCORE, self.score >= rules.min_score), (Reason.MARGIN, self.margin >= rules.min_margin),
                  (Reason.BORDER, self.inside))
        reason = next((reason for reason, good in checks if not good), Reason.NONE)
        return Measurement(self.dx, self.dy, self.score, self.margin, reason is Reason.NONE, reason)


def _refuse(m: Measurement, reason: Reason) -> Measurement:
    return Measurement(m.dx_px, m.dy_px, m.score, m.margin, False, reason)


def _search(q: Query) -> Job | None:
    """The job that answers a query, its search clipped to the picture; None where nothing is left of it."""
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
    """The query from the place found back to the start, over as large a search as the forward one."""
    dx, dy = round(m.dx_px), round(m.dy_px)
    return Query(q.live, q.reference, q.x + dx, q.y + dy, q.width, q.height, (-dx, -dy), q.reach)


def _refine(jobs: Sequence[Job], results: Sequence[Result], fit: Fit) -> list[_Peak]:
    peaks = []
    whole = [i for i, r in enumerate(results) if r.status is Status.OK and NO_SCORE not in r.neighbours]
    patches = np.array([[*results[i].neighbours[:4], results[i].score, *results[i].neighbours[4:]] for i in whole])
    areas = np.array([jobs[i].width * jobs[i].height for i in whole], np.float64)
    tips = dict(zip(whole, peak_offsets(patches.reshape(-1, 3, 3), areas, fit), strict=True))
    for i, (job, r) in enumerate(zip(jobs, results, strict=True)):
        if r.status is not Status.OK:
            peaks.append(_Peak(r.status))
            continue
        area = job.width * job.height
        score = r.score / area
        runner_up = 0.5 if r.runner_up == NO_SCORE else r.runner_up / area
        tip = tips.get(i)
        if tip is None:
            tip = _line_tip(r, area, "cone" if fit == "cone" or (fit == "auto" and score >= CONE_FROM) else "parabola")
        inside = ((0 < r.best_x < job.offsets_x - 1 or job.offsets_x == 1)
                  and (0 < r.best_y < job.offsets_y - 1 or job.offsets_y == 1))
        peaks.append(_Peak(r.status, job.search_x + r.best_x - job.tpl_x + float(tip[0]),
                           job.search_y + r.best_y - job.tpl_y + float(tip[1]), score, score - runner_up, inside))
    return peaks


def _line_tip(r: Result, area: int, fit: Fit) -> tuple[float, float]:
    """Sub-pixel tip along the lines that have both neighbours; 0 along the others."""
    def along(before: int, after: int) -> float:
        if NO_SCORE in (before, after):
            return 0.0
        return line_offset(before / area, r.score / area, after / area, "cone" if fit == "cone" else "parabola")

    return along(r.neighbours[3], r.neighbours[4]), along(r.neighbours[1], r.neighbours[6])
