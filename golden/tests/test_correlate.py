# SPDX-License-Identifier: Apache-2.0
"""Frame-level correlation against brute force, and its properties."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from golden.correlate import (
    COORDINATE_MAX,
    Job,
    Plane,
    Result,
    Status,
    Surface,
    above_chance,
    check,
    grid,
    peak,
    run,
    surface,
)
from golden.params import FULL, NO_SCORE, TINY, Config
from golden.structs import JOB

WIDTH, HEIGHT = 48, 36
SIZE = (WIDTH, HEIGHT)


def random_plane(seed: int, size: tuple[int, int] = SIZE, ones: float = 0.5) -> Plane:
    return (np.random.default_rng(seed).random((size[1], size[0])) < ones).astype(np.uint8)


def brute_surface(a: Plane, b: Plane, job: Job) -> Surface:
    """The definition, a window at a time, in integers."""
    t = a[job.tpl_y:job.tpl_y + job.height, job.tpl_x:job.tpl_x + job.width]
    out = np.empty((job.offsets_y, job.offsets_x), dtype=np.int32)
    for y in range(job.offsets_y):
        for x in range(job.offsets_x):
            top, left = job.search_y + y, job.search_x + x
            out[y, x] = np.count_nonzero(t == b[top:top + job.height, left:left + job.width])
    return out


def brute_peak(s: Surface) -> tuple[int, int, int, tuple[int, ...], int]:
    """The definition, an offset at a time."""
    rows, cols = s.shape
    best = (-1, 0, 0)
    for y in range(rows):
        for x in range(cols):
            if s[y, x] > best[0]:
                best = (int(s[y, x]), y, x)
    score, by, bx = best
    near = [(by + dy, bx + dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
    around = tuple(int(s[p]) if 0 <= p[0] < rows and 0 <= p[1] < cols else NO_SCORE
                   for p in near if p != (by, bx))
    outside = [int(s[y, x]) for y in range(rows) for x in range(cols) if (y, x) not in near]
    return bx, by, score, around, max(outside, default=NO_SCORE)


@st.composite
def jobs(draw: st.DrawFn, size: tuple[int, int] = SIZE, config: Config = TINY) -> Job:
    """Acceptable jobs within an image of `size`, the borders included."""
    w, h = (draw(st.integers(config.min_window, config.max_window)) for _ in range(2))
    ox, oy = draw(st.integers(1, size[0] - w + 1)), draw(st.integers(1, size[1] - h + 1))
    return Job(tpl_slot=0, tpl_x=draw(st.integers(0, size[0] - w)), tpl_y=draw(st.integers(0, size[1] - h)),
               width=w, height=h, search_slot=1, search_x=draw(st.integers(0, size[0] - w - ox + 1)),
               search_y=draw(st.integers(0, size[1] - h - oy + 1)), offsets_x=ox, offsets_y=oy,
               tag=draw(st.integers(0, 65535)), surface=draw(st.booleans()))


PLANES = st.builds(random_plane, st.integers(0, 99), ones=st.sampled_from([0.5, 0.02, 0.98, 0.0, 1.0]))


@settings(max_examples=60, deadline=None)
@given(jobs(), PLANES, PLANES)
def test_surface_is_the_definition(job: Job, a: Plane, b: Plane) -> None:
    np.testing.assert_array_equal(surface(a, b, job), brute_surface(a, b, job))


@pytest.mark.parametrize("ones", [(0.5, 0.5), (1.0, 1.0), (1.0, 0.0), (0.97, 0.5), (0.0, 0.0)])
@pytest.mark.parametrize("window", [(128, 128), (64, 64), (8, 128), (127, 33)])
def test_surface_is_exact_over_whole_frames(window: tuple[int, int], ones: tuple[float, float]) -> None:
    """Whole-frame searches against an independent float64 FFT, whose own error is proved to be tiny."""
    w, h = window
    a, b = random_plane(1, (640, 480), ones[0]), random_plane(2, (640, 480), ones[1])
    job = Job(0, 301, 207, w, h, 1, 0, 0, 640 - w + 1, 480 - h + 1)
    t = 2.0 * a[207:207 + h, 301:301 + w] - 1.0
    product = np.fft.irfft2(np.fft.rfft2(2.0 * b - 1.0) * np.conj(np.fft.rfft2(t, (480, 640))), (480, 640))
    scores = (w * h + product[:480 - h + 1, :640 - w + 1]) / 2
    assert np.abs(scores - np.rint(scores)).max() < 1e-6
    got = surface(a, b, job)
    np.testing.assert_array_equal(got, np.rint(scores).astype(np.int32))
    rng = np.random.default_rng(3)
    for x, y in zip(rng.integers(0, job.offsets_x, 25), rng.integers(0, job.offsets_y, 25), strict=True):
        one = replace(job, search_x=int(x), search_y=int(y), offsets_x=1, offsets_y=1)
        assert brute_surface(a, b, one)[0, 0] == got[y, x]


@settings(max_examples=60, deadline=None)
@given(jobs(), PLANES, PLANES)
def test_negation(job: Job, a: Plane, b: Plane) -> None:
    both = surface(1 - a, 1 - b, job)
    np.testing.assert_array_equal(both, surface(a, b, job))
    np.testing.assert_array_equal(surface(1 - a, b, job), job.width * job.height - both)


@settings(max_examples=40, deadline=None)
@given(jobs(), PLANES, st.integers(-5, 5), st.integers(-5, 5))
def test_shift_is_found(job: Job, a: Plane, dx: int, dy: int) -> None:
    """A template plane, rolled, has a perfect score at the offset of the roll, if that offset is searched."""
    b = np.roll(a, (dy, dx), (0, 1))
    x, y = job.tpl_x + dx, job.tpl_y + dy
    inside = (x >= 0 and x + job.width <= WIDTH and y >= 0 and y + job.height <= HEIGHT)
    if inside and 0 <= x - job.search_x < job.offsets_x and 0 <= y - job.search_y < job.offsets_y:
        assert surface(a, b, job)[y - job.search_y, x - job.search_x] == job.width * job.height
        assert run(job, {0: a, 1: b}, TINY, SIZE).score == job.width * job.height


@settings(max_examples=40, deadline=None)
@given(jobs(), PLANES, PLANES, st.data())
def test_a_smaller_search_is_a_crop(job: Job, a: Plane, b: Plane, data: st.DataObject) -> None:
    x, y = data.draw(st.integers(0, job.offsets_x - 1)), data.draw(st.integers(0, job.offsets_y - 1))
    part = replace(job, search_x=job.search_x + x, search_y=job.search_y + y,
                   offsets_x=job.offsets_x - x, offsets_y=job.offsets_y - y)
    np.testing.assert_array_equal(surface(a, b, part), surface(a, b, job)[y:, x:])


@settings(max_examples=300, deadline=None)
@given(st.integers(1, 7), st.integers(1, 7), st.integers(1, 200), st.integers(0, 2**31))
def test_peak_is_the_definition(rows: int, cols: int, top: int, seed: int) -> None:
    """Small ranges make ties; one to three rows and columns are where neighbours and runner-up are missing."""
    s = np.random.default_rng(seed).integers(0, top + 1, (rows, cols)).astype(np.int32)
    assert peak(s) == brute_peak(s)


def test_peak_without_surroundings() -> None:
    assert peak(np.array([[7]], dtype=np.int32)) == (0, 0, 7, (NO_SCORE,) * 8, NO_SCORE)
    flat = np.zeros((3, 3), dtype=np.int32)
    assert peak(flat) == (0, 0, 0, (*[NO_SCORE] * 4, 0, NO_SCORE, 0, 0), 0)


GOOD = Job(0, 10, 10, 16, 8, 1, 5, 6, 20, 10, tag=77)


@pytest.mark.parametrize(("change", "status"), [
    ({}, Status.OK),
    ({"width": 1}, Status.BAD_WINDOW), ({"width": 17}, Status.BAD_WINDOW), ({"width": 2}, Status.OK),
    ({"height": 1}, Status.BAD_WINDOW), ({"height": 17}, Status.BAD_WINDOW), ({"height": 16}, Status.OK),
    ({"offsets_x": 0}, Status.NO_OFFSETS), ({"offsets_y": 0}, Status.NO_OFFSETS),
    ({"tpl_slot": 2}, Status.BAD_SLOT), ({"search_slot": 2}, Status.BAD_SLOT), ({"tpl_slot": 7}, Status.BAD_SLOT),
    ({"tpl_slot": 6}, Status.BAD_SLOT), ({"search_slot": 6}, Status.BAD_SLOT), ({"search_slot": 5}, Status.OK),
    ({"tpl_x": 32}, Status.OK), ({"tpl_x": 33}, Status.OUTSIDE),
    ({"tpl_y": 28}, Status.OK), ({"tpl_y": 29}, Status.OUTSIDE),
    ({"offsets_x": 28}, Status.OK), ({"offsets_x": 29}, Status.OUTSIDE),
    ({"offsets_y": 23}, Status.OK), ({"offsets_y": 24}, Status.OUTSIDE),
    ({"search_x": 1023}, Status.OUTSIDE), ({"search_y": 1023}, Status.OUTSIDE),
    ({"width": 0, "offsets_x": 0, "tpl_slot": 7, "tpl_x": 1023}, Status.BAD_WINDOW),
    ({"offsets_x": 0, "tpl_slot": 7, "tpl_x": 1023}, Status.NO_OFFSETS),
    ({"tpl_slot": 7, "tpl_x": 1023}, Status.BAD_SLOT),
])
def test_check(change: dict[str, int], status: Status) -> None:
    job = replace(GOOD, **change)  # type: ignore[arg-type]
    planes = {slot: random_plane(slot) for slot in (0, 1, 5, 6, 7)}
    assert check(job, TINY, SIZE, planes) is status
    assert check(job, TINY, SIZE, [True, True, False, False, False, True, True, True]) is status
    result = run(job, planes, TINY, SIZE)
    assert (result.status, result.tag) == (status, 77)
    if status is not Status.OK:
        assert (result.best_x, result.best_y, result.score, result.runner_up) == (0, 0, NO_SCORE, NO_SCORE)
        assert result.neighbours == (NO_SCORE,) * 8


@settings(max_examples=40, deadline=None)
@given(jobs(), PLANES, PLANES)
def test_run_joins_surface_and_peak(job: Job, a: Plane, b: Plane) -> None:
    r = run(job, {0: a, 1: b}, TINY, SIZE)
    assert (r.best_x, r.best_y, r.score, r.neighbours, r.runner_up) == brute_peak(brute_surface(a, b, job))
    assert (r.tag, r.status) == (job.tag, Status.OK)


def test_bad_arguments_are_named() -> None:
    with pytest.raises(ValueError, match="tpl_x is -1"):
        replace(GOOD, tpl_x=-1)
    with pytest.raises(ValueError, match="reaches outside"):
        surface(random_plane(1), random_plane(2), replace(GOOD, search_x=40))
    with pytest.raises(ValueError, match="counts"):
        grid(GOOD, (0, 1), (1, 1))


@given(st.integers(1, 6), st.integers(1, 6), st.integers(0, COORDINATE_MAX), st.integers(0, COORDINATE_MAX))
def test_grid(nx: int, ny: int, sx: int, sy: int) -> None:
    first = replace(GOOD, tag=65533)
    laid = grid(first, (nx, ny), (sx, sy))
    assert len(laid) == nx * ny and laid[0] == first
    for k, job in enumerate(laid):
        j, i = divmod(k, nx)
        assert job.tag == (65533 + k) % 65536
        assert (job.tpl_x, job.search_x) == (min(10 + i * sx, 1023), min(5 + i * sx, 1023))
        assert (job.tpl_y, job.search_y) == (min(10 + j * sy, 1023), min(6 + j * sy, 1023))
        moved = (GOOD.tpl_x + i * sx, GOOD.search_x + i * sx, GOOD.tpl_y + j * sy, GOOD.search_y + j * sy)
        if max(moved) > COORDINATE_MAX:
            assert check(job, FULL, (640, 480), [True] * 8) is Status.OUTSIDE


def test_above_chance() -> None:
    assert above_chance(0.75, 4096, 2.0) == pytest.approx(0.5 * 64 / (1.1 * 2.0))
    assert above_chance(0.5, 100, 1.0) == 0
    assert above_chance(0.25, 100, 3.0) == pytest.approx(-5 / 3.3)
    result = Result(GOOD.tag, Status.OK, 1, 2, 96, (1, 2, 3, 4, 5, 6, 7, 8), 50)
    assert result.above_chance(GOOD, 1.5) == pytest.approx(above_chance(96 / 128, 128, 1.5))
    assert replace(result, status=Status.OUTSIDE).above_chance(GOOD, 1.5) == 0


def test_patch_is_in_raster_order() -> None:
    patch = Result(1, Status.OK, 0, 0, 9, (1, 2, 3, 4, 5, 6, 7, 8)).patch
    assert patch.dtype == np.int32
    assert patch.tolist() == [[1, 2, 3], [4, 9, 5], [6, 7, 8]]


@pytest.mark.parametrize("name", ["tag", "tpl_slot", "search_slot", "width", "height", "tpl_x", "tpl_y", "search_x",
                                  "search_y", "offsets_x", "offsets_y"])
def test_jobs_fit_their_registers(name: str) -> None:
    top = (1 << next(bits for field, bits in JOB.fields if field == name)) - 1
    for value in (0, top):
        assert getattr(replace(GOOD, **{name: value}), name) == value  # type: ignore[arg-type]
    for value in (-1, top + 1):
        with pytest.raises(ValueError, match=f"{name} is {value}: must lie in 0..{top}"):
            replace(GOOD, **{name: value})  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=f"{name} is 1.0: must be a whole number"):
        replace(GOOD, **{name: 1.0})  # type: ignore[arg-type]
    assert type(getattr(replace(GOOD, **{name: np.int16(1)}), name)) is int  # type: ignore[arg-type]


def test_limits_of_arguments() -> None:
    plain = Job(0, 10, 10, 16, 8, 1, 5, 6, 20, 10)
    assert (plain.tag, plain.surface) == (0, False)
    for change in ({"tpl_x": 40}, {"tpl_y": 30}, {"search_y": 30}):
        with pytest.raises(ValueError, match="reaches outside"):
            surface(random_plane(1), random_plane(2), replace(GOOD, **change))  # type: ignore[arg-type]
    assert len(grid(GOOD, (1023, 1), (1023, 0))) == len(grid(GOOD, (1, 1023), (0, 1023))) == 1023
    for count, step in (((1024, 1), (0, 0)), ((1, 0), (0, 0)), ((1, 1), (1024, 0)), ((1, 1), (0, -1))):
        with pytest.raises(ValueError, match="counts must lie"):
            grid(GOOD, count, step)


def test_status_codes() -> None:
    assert {status.name: status.value for status in Status} == {
        "OK": 0, "BAD_WINDOW": 1, "NO_OFFSETS": 2, "BAD_SLOT": 3, "OUTSIDE": 4}
