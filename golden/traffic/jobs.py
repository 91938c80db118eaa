# SPDX-License-Identifier: Apache-2.0
"""Random jobs of every kind, for tests: acceptable ones of all shapes, and refused ones of every status."""

from __future__ import annotations

import random
from dataclasses import replace

from golden.correlate import Job, Status, check
from golden.params import Config

KINDS = ("any", "paired", "wide", "odd", "line", "column", "single", "whole", "same_width", "max_window")


def acceptable(rng: random.Random, config: Config, image_size: tuple[int, int], kind: str = "any",
               most_offsets: int = 400) -> Job:
    """A job inside an image of `image_size` (width, height), at most `most_offsets` offsets unless `kind` is `whole`.

    Raises:
        ValueError: for an unknown kind.
    """
    if kind not in KINDS:
        raise ValueError(f"unknown kind {kind!r}: one of {', '.join(KINDS)}")
    g, lo, hi = config.group_bits, config.min_window, config.max_window
    w, h = rng.randint(lo, hi), rng.randint(lo, hi)
    if kind == "paired":
        w = rng.randint(lo, g)
    elif kind == "wide":
        w = rng.randint(g + 1, hi)
    elif kind == "odd":
        w, h = rng.randint(lo, g), rng.randrange(lo | 1, hi, 2)
    elif kind == "same_width":
        w = g
    elif kind == "max_window":
        w, h = rng.choice((g, hi)), hi
    width, height = image_size
    across, down = width - w + 1, height - h + 1
    if kind == "whole":
        nx, ny = across, down
    else:
        nx = 1 if kind in ("column", "single") else rng.randint(1, across)
        ny = 1 if kind in ("line", "single") else rng.randint(1, down)
        ny = max(min(ny, most_offsets // nx), 1)
    return Job(tpl_slot=rng.randrange(config.slots), tpl_x=rng.randrange(across), tpl_y=rng.randrange(down), width=w,
               height=h, search_slot=rng.randrange(config.slots), search_x=rng.randint(0, across - nx),
               search_y=rng.randint(0, down - ny), offsets_x=nx, offsets_y=ny, tag=rng.getrandbits(16),
               surface=rng.random() < 0.3)


def refused(rng: random.Random, config: Config, image_size: tuple[int, int], slot_valid: list[bool],
            status: Status) -> Job:
    """A job refused with `status`, where possible one step away from an acceptable one.

    Raises:
        ValueError: if `status` is OK.
    """
    width, height = image_size
    for _ in range(10000):
        job = acceptable(rng, config, image_size)
        good = [s for s in range(config.slots) if slot_valid[s]]
        job = replace(job, tpl_slot=rng.choice(good), search_slot=rng.choice(good))
        if status is Status.BAD_WINDOW:
            size = rng.choice((0, config.min_window - 1, config.max_window + 1, 255))
            job = rng.choice((replace(job, width=size), replace(job, height=size)))
        elif status is Status.NO_OFFSETS:
            job = rng.choice((replace(job, offsets_x=0), replace(job, offsets_y=0)))
        elif status is Status.BAD_SLOT:
            bad = rng.choice([s for s in range(8) if s >= config.slots or not slot_valid[s]])
            job = rng.choice((replace(job, tpl_slot=bad), replace(job, search_slot=bad)))
        elif status is Status.OUTSIDE:
            job = rng.choice((
                replace(job, tpl_x=width - job.width + 1), replace(job, tpl_y=height - job.height + 1),
                replace(job, search_x=width - job.width - job.offsets_x + 2),
                replace(job, search_y=height - job.height - job.offsets_y + 2),
                replace(job, search_x=1023), replace(job, tpl_y=1023), replace(job, offsets_x=1023),
                replace(job, offsets_y=1023)))
        else:
            raise ValueError("status must be one of a refused job")
        if rng.random() < 0.2 and status is not Status.OUTSIDE:
            job = replace(job, tpl_x=1023)  # a later fault must not be reported
        if check(job, config, image_size, slot_valid) is status:
            return job
    raise AssertionError(f"no job of status {status.name} found")


def mixed(rng: random.Random, config: Config, image_size: tuple[int, int], slot_valid: list[bool], count: int,
          most_offsets: int = 400) -> list[Job]:
    """`count` jobs in random order: about one in four refused; every kind and status appears if `count` allows."""
    good = [s for s in range(config.slots) if slot_valid[s]]
    jobs = []
    for k in range(count):
        if k % 4 == 3:
            status = list(Status)[1 + k // 4 % 4]
            jobs.append(refused(rng, config, image_size, slot_valid, status))
        else:
            kind = KINDS[(k - k // 4) % len(KINDS)]
            job = acceptable(rng, config, image_size, kind, most_offsets)
            jobs.append(replace(job, tpl_slot=rng.choice(good), search_slot=rng.choice(good)))
    rng.shuffle(jobs)
    return jobs
