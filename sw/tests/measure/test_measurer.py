# SPDX-License-Identifier: Apache-2.0
"""Measurements on the golden board: accuracy, and that each check refuses what it is there for."""

import cv2
import numpy as np
import pytest
import skimage.data

from golden.params import FULL
from signum.boards.board import BoardError
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Image
from signum.measure.measurer import Measurement, Measurer, Query, white_match
from signum.measure.validity import Reason, Rules
from signum.world.degrade import degrade

SIZE = 400, 320


def _photo(name: str = "gravel") -> Image:
    return np.asarray(getattr(skimage.data, name)(), np.uint8)


def _shifted(photo: Image, dx: float, dy: float) -> Image:
    """The picture's middle, with what it shows moved by (dx, dy)."""
    matrix = np.array([[1, 0, dx - 56], [0, 1, dy - 96]], np.float64)
    return np.asarray(cv2.warpAffine(photo, matrix, SIZE, flags=cv2.INTER_CUBIC), np.uint8)


def _grid(size: int = 64, step: int = 60) -> list[tuple[int, int]]:
    return [(x, y) for y in range(60, SIZE[1] - 60, step) for x in range(60, SIZE[0] - 60, step)]


def _errors(before: Image, after: Image, shift: tuple[float, float], sigma: float, rules: Rules) -> list[float]:
    with GoldenBoard() as board:
        m = Measurer(board, SIZE, sigma, rules)
        a, b = m.view(before), m.view(after)
        found = m.measure([Query(a, b, x, y, 64, 64) for x, y in _grid()])
    return [float(np.hypot(f.dx_px - shift[0], f.dy_px - shift[1])) for f in found if f.valid]


@pytest.mark.parametrize("sigma", [1.0, 2.5, 4.0])
def test_clean_shifts(sigma: float) -> None:
    errors = []
    for shift in ((3.3, -2.6), (-7.5, 0.2), (0.0, 4.9)):
        errors += _errors(_shifted(_photo(), 0, 0), _shifted(_photo(), *shift), shift, sigma, Rules())
    rms = float(np.sqrt(np.mean(np.square(errors))))
    print(f"sigma {sigma:g}: {len(errors)} valid, RMS {rms:.3f} px")
    assert len(errors) >= 0.9 * 3 * len(_grid()) and rms < 0.1


def test_degraded_shifts() -> None:
    shift = (5.4, -3.7)
    errors = _errors(degrade(_shifted(_photo(), 0, 0), 1), degrade(_shifted(_photo(), *shift), 2), shift, 2.5, Rules())
    assert len(errors) >= 0.8 * len(_grid()) and np.sqrt(np.mean(np.square(errors))) < 0.25


def test_other_places_are_never_called_valid() -> None:
    """Windows of a picture that is not there at all."""
    with GoldenBoard() as board:
        m = Measurer(board, SIZE, 2.5)
        a, b = m.view(_shifted(_photo("gravel"), 0, 0)), m.view(_shifted(_photo("grass"), 0, 0))
        found = m.measure([Query(a, b, x, y, 64, 64, reach=(24, 24)) for x, y in _grid()])
    assert len(found) >= 20 and not any(f.valid for f in found)
    assert {f.reason for f in found} <= {Reason.SCORE, Reason.MARGIN, Reason.BORDER, Reason.RETURN}


def _one(a: Image, b: Image, query: tuple[int, int, int, int], rules: Rules | None = None, **more: tuple[int, int],
         ) -> Measurement:
    with GoldenBoard() as board:
        m = Measurer(board, SIZE, 2.5, rules)
        views = m.view(a), m.view(b)
        (found,) = m.measure([Query(*views, *query, **more)])  # type: ignore[arg-type]
    return found


def test_reasons() -> None:
    still = _shifted(_photo(), 0, 0)
    assert _one(still, still, (200, 160, 64, 64)).reason is Reason.NONE
    assert _one(still, still, (20, 160, 64, 64)).reason is Reason.OUTSIDE
    assert _one(still, still, (200, 160, 64, 64), guess=(400, 0)).reason is Reason.OUTSIDE
    assert _one(still, _shifted(_photo(), 30, 0), (200, 160, 64, 64), Rules(min_score=0.9)).reason is Reason.SCORE
    assert _one(still, still, (200, 160, 64, 64), Rules(min_margin=0.6)).reason is Reason.MARGIN
    border = _one(still, _shifted(_photo(), 16, 0), (200, 160, 64, 64), Rules(min_margin=0.0))
    assert border.reason is Reason.BORDER and border.dx_px == 16
    flat = np.full(SIZE[::-1], 90, np.uint8)
    assert not _one(flat, flat, (200, 160, 64, 64)).valid
    edge = flat.copy()
    edge[:, 200:] = 160
    assert not _one(edge, edge, (200, 160, 64, 64)).valid
    along = Rules(min_margin=0.0)  # a search across the edge is sharp, and still the window is no more than an edge
    assert _one(edge, edge, (200, 160, 64, 64), along, reach=(8, 0)).reason is Reason.TEXTURE


def test_backward_search_must_return() -> None:
    """A window matches a similar object beside its own place: the backward search ends at that object."""
    rng = np.random.default_rng(3)
    reference, live = (rng.integers(0, 256, SIZE[::-1], dtype=np.uint8) for _ in range(2))
    window = reference[136:184, 126:174].astype(np.float64)
    double = np.clip(0.7 * window + 0.3 * live[140:188, 130:178], 0, 255).astype(np.uint8)
    live[140:188, 130:178] = double
    reference[136:184, 176:224] = double
    reach = (56, 16)
    true = _one(reference, live, (200, 160, 40, 40), guess=(-46, 4), reach=reach)
    assert true.valid and (round(true.dx_px), round(true.dy_px)) == (-46, 4)
    false = _one(reference, live, (150, 160, 40, 40), reach=reach)
    assert false.reason is Reason.RETURN and (round(false.dx_px), round(false.dy_px)) == (4, 4)
    assert _one(reference, live, (150, 160, 40, 40), Rules(backward=False), reach=reach).valid


def test_views_are_bounded_and_released() -> None:
    frame = _shifted(_photo(), 0, 0)
    with GoldenBoard() as board:
        m = Measurer(board, SIZE)
        views = [m.view(frame) for _ in range(FULL.slots - 2)]
        views += m.pair(frame, frame)
        with pytest.raises(RuntimeError, match="release"):
            m.view(frame)
        m.release(views[2])
        assert m.free_views == 1
        with pytest.raises(RuntimeError, match="pair"):
            m.pair(frame, frame)
        with pytest.raises(ValueError, match="released before"):
            m.release(views[2])


@pytest.mark.parametrize("size", [SIZE, (320, 240)], ids=["alike", "of another size"])
def test_a_measurer_whose_board_was_taken_over_raises(size: tuple[int, int]) -> None:
    """Even a measurer just alike takes over the slots: the earlier one's views are no longer what they were."""
    frame = _shifted(_photo(), 0, 0)
    with GoldenBoard() as board:
        early = Measurer(board, SIZE, 2.5)
        views = early.pair(frame, frame)
        late = Measurer(board, size, 2.5)
        for call in (lambda: early.view(frame), lambda: early.pair(frame, frame), lambda: early.signs(views[0]),
                     lambda: early.measure([Query(*views, 200, 160, 64, 64)]), lambda: early.measure([]),
                     lambda: early.likeness(views[0], [(200, 160, 64, 64)])):
            with pytest.raises(BoardError, match="another Measurer"):
                call()
        early.release(views[0])  # clean-up never fails
        with pytest.raises(ValueError, match="another Measurer"):
            late.measure([Query(*views, 100, 100, 64, 64)])
        assert late.signs(late.view(frame[:size[1], :size[0]])).shape == size[::-1]
        board.configure(size, 2.5)
        with pytest.raises(BoardError, match="another Measurer"):
            late.view(frame[:size[1], :size[0]])


def test_measurers_of_two_boards_do_not_mind_each_other() -> None:
    frame = _shifted(_photo(), 0, 0)
    with GoldenBoard() as board, GoldenBoard() as other:
        one, two = Measurer(board, SIZE), Measurer(other, SIZE)
        view = one.view(frame)
        two.view(frame)
        assert one.measure([Query(view, view, 200, 160, 64, 64)])[0].valid
        with pytest.raises(ValueError, match="another Measurer"):
            two.signs(view)


def test_lines_for_one_dimensional_searches() -> None:
    with GoldenBoard() as board:
        m = Measurer(board, SIZE, 1.5)
        a, b = m.view(_shifted(_photo(), 0, 0)), m.view(_shifted(_photo(), -6.4, 0))
        found = m.measure([Query(a, b, x, y, 64, 64, (-8, 0), (8, 0)) for x, y in _grid()])
    good = [f for f in found if f.valid]
    assert len(good) >= 0.9 * len(found)
    assert np.sqrt(np.mean([(f.dx_px + 6.4) ** 2 for f in good])) < 0.1
    assert all(f.dy_px == 0 for f in good)


def test_white_match_is_the_theory() -> None:
    """Signs of filtered white noise against the closed form."""
    noise = np.random.default_rng(0).integers(0, 256, (480, 640), dtype=np.uint8)
    with GoldenBoard() as board:
        board.configure((640, 480), 2.5)
        board.capture(0, noise)
        plane = board.read_plane(0)
    for d in (1, 2, 3, 5):
        assert (plane[:, d:] == plane[:, :-d]).mean() == pytest.approx(white_match(d, 2.5), abs=0.01)
