# SPDX-License-Identifier: Apache-2.0
"""Fetch and sequencer models: their operand writes and steps, replayed on plain memories, give brute-force scores."""

from __future__ import annotations

import random
from itertools import cycle

import pytest

from golden.correlate import Job, Plane, Status, check
from golden.params import FULL, TINY, Config
from golden.structs import JOB, pack_job, unpack_job
from golden.traffic.correlator import random_planes
from golden.traffic.fetch_loop import FetchLoop
from golden.traffic.jobs import KINDS, acceptable, mixed, refused
from golden.traffic.stalls import coin


def _mismatches(planes: dict[int, Plane], job: Job) -> list[int]:
    """Hamming distances in raster order, window by window."""
    template = planes[job.tpl_slot][job.tpl_y:job.tpl_y + job.height, job.tpl_x:job.tpl_x + job.width]
    search = planes[job.search_slot]
    return [int((template != search[y:y + job.height, x:x + job.width]).sum())
            for y in range(job.search_y, job.search_y + job.offsets_y)
            for x in range(job.search_x, job.search_x + job.offsets_x)]


def _compare(loop: FetchLoop, planes: dict[int, Plane], jobs: list[Job], size: tuple[int, int]) -> int:
    """Contexts and mismatches of a finished run against the jobs; returns the scores compared."""
    valid = [s in planes for s in range(8)]
    statuses = [check(j, loop.config, size, valid) for j in jobs]
    tags = [j.tag for j in jobs]
    assert [(c["tag"], c["status"]) for c in loop.contexts] == list(zip(tags, statuses, strict=True))
    good = [j for j, s in zip(jobs, statuses, strict=True) if s is Status.OK]
    seen = [m for lanes in loop.replay.mismatches for m in lanes]
    assert seen == [m for job in good for m in _mismatches(planes, job)]
    assert all(c["area"] == j.width * j.height for c, j in zip(loop.contexts, jobs, strict=True)
               if c["status"] == Status.OK)
    assert loop.granted == sum(j.offsets_y for j in good)
    return len(seen)


@pytest.mark.parametrize("stalls", ["none", "random", "cyclic"])
@pytest.mark.parametrize("size", [(48, 36), (41, 23), (18, 18)])
def test_random_jobs(size: tuple[int, int], stalls: str) -> None:
    rng = random.Random(f"{size}{stalls}")
    planes = random_planes(TINY, [0, 2, 3, 5], 7, size=size)
    jobs = mixed(rng, TINY, size, [s in planes for s in range(8)], 28, most_offsets=150)
    loop = FetchLoop(TINY, planes)
    if stalls == "none":
        loop.run(jobs)
    elif stalls == "random":
        loop.run(jobs, coin(0.3, rng), coin(0.3, rng), coin(0.3, rng))
    else:
        loop.run(jobs, cycle((1, 0)), cycle((0, 0, 1)), cycle((1, 1, 1, 0)))
    assert _compare(loop, planes, jobs, size) > 500
    assert loop.replay.clock > 500


@pytest.mark.parametrize("x", range(10))
def test_every_alignment(x: int) -> None:
    """Template and search at every place in a store word, windows at the group's edge."""
    planes = random_planes(TINY, [0, 1], 11)
    jobs = [Job(0, x, y, w, h, 1, (x * 3 + w) % 8, 5, 9, 2)
            for w in (7, 8, 9, 16) for h, y in ((2, 1), (3, 20), (16, 20))]
    loop = FetchLoop(TINY, planes)
    loop.run(jobs)
    assert _compare(loop, planes, jobs, (48, 36)) == 12 * 18


@pytest.mark.parametrize("nx", [1, 2, 3, 4, 5, 6, 8, 9, 10, 33])
def test_every_split(nx: int) -> None:
    """Passes along a row: one or two short of, at, and past the pitch."""
    planes = random_planes(TINY, [0], 12)
    jobs = [Job(0, 3, 4, w, h, 0, 0, 0, nx, 2) for w in (8, 14) for h in (2, 3, 16)]
    loop = FetchLoop(TINY, planes)
    loop.run(jobs)
    assert _compare(loop, planes, jobs, (48, 36)) == 6 * 2 * nx
    chunks = [len(p) for p in loop.replay.mismatches]
    assert max(chunks) <= TINY.lanes and chunks[:-1].count(1) <= (len(chunks) if nx == 1 else 0)


@pytest.mark.parametrize("kind", ["whole", "max_window"])
def test_ring_wraps(kind: str) -> None:
    """Far more rows than the ring holds, through both kinds of window."""
    rng = random.Random(3)
    planes = random_planes(TINY, range(6), 13)
    jobs = [acceptable(rng, TINY, (48, 36), kind) for _ in range(4)]
    loop = FetchLoop(TINY, planes)
    loop.run(jobs)
    assert sum(j.height + j.offsets_y - 1 for j in jobs) > 2 * TINY.ring_rows
    assert _compare(loop, planes, jobs, (48, 36)) > 500


def test_full_geometry() -> None:
    """Both modes and largest windows at full size."""
    planes = random_planes(FULL, [0, 5], 14)
    jobs = [Job(5, 511, 351, 128, 128, 0, 512, 350, 1, 3), Job(0, 61, 5, 64, 63, 5, 3, 417, 70, 1),
            Job(0, 7, 5, 65, 9, 5, 575 - 40, 11, 41, 2), Job(5, 632, 472, 8, 8, 0, 0, 472, 633, 1)]
    loop = FetchLoop(FULL, planes)
    loop.run(jobs)
    assert _compare(loop, planes, jobs, (640, 480)) == 3 + 70 + 82 + 633


def _needed(config: Config, jobs: list[Job]) -> int:
    """Clocks the array cannot do without: per pass its steps, or its offsets where those are more."""
    clocks = 0
    for job in jobs:
        steps = job.height if job.width > config.group_bits else -(-job.height // 2)
        passes = max(-(-(job.offsets_x - 1) // config.pitch), 1)
        last = job.offsets_x - (passes - 1) * config.pitch
        clocks += job.offsets_y * ((passes - 1) * max(steps, config.pitch) + max(steps, last))
    return clocks


@pytest.mark.parametrize(("config", "window", "reach", "count"), [
    (TINY, (8, 8), 8, 12), (TINY, (8, 16), 8, 8), (TINY, (16, 16), 8, 8), (FULL, (64, 64), 32, 3)])
def test_utilisation(config: Config, window: tuple[int, int], reach: int, count: int) -> None:
    """A queue of equal searches keeps the array busy, its first load included; at full size it always scores."""
    size = (config.max_width, config.max_height)
    planes = random_planes(config, [0, 1], 15, size=size)
    n = 2 * reach + 1
    jobs = [Job(0, 3 + k, 1, *window, 1, 5 + k, 2, n, n) for k in range(count)]
    loop = FetchLoop(config, planes)
    steps = 0

    def count_steps(out: dict[str, int | None]) -> None:
        nonlocal steps
        steps += out["step_valid_o"] or 0

    clocks = loop.run(jobs, observe=count_steps)
    ratio = _needed(config, jobs) / clocks
    print(f"{config.name} {window} +-{reach}: {ratio:.3f} of {clocks} clocks useful, {steps / clocks:.3f} stepping, "
          f"{count * n * n / clocks:.3f} scores a clock")
    assert ratio >= 0.95
    if config is FULL:
        assert count * n * n / clocks >= 0.95 and steps / clocks >= 0.93
    else:
        _compare(loop, planes, jobs, size)


def test_jobs_of_every_kind() -> None:
    rng = random.Random(5)
    valid = [True, False, True, True, True, True, False, False]
    for kind in KINDS:
        for _ in range(50):
            assert check(acceptable(rng, TINY, (40, 30), kind), TINY, (40, 30), [True] * 8) is Status.OK
    for status in list(Status)[1:]:
        for _ in range(50):
            assert check(refused(rng, TINY, (40, 30), valid, status), TINY, (40, 30), valid) is status


def test_structs_round_trip() -> None:
    rng = random.Random(6)
    for _ in range(100):
        job = acceptable(rng, FULL, (640, 480))
        assert unpack_job(pack_job(job)) == job
        assert JOB.unpack(pack_job(job))["search_y"] == job.search_y
    with pytest.raises(ValueError, match="does not fit"):
        JOB.pack({**JOB.unpack(0), "width": 256})
