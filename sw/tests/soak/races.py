# SPDX-License-Identifier: Apache-2.0
"""Captures that race searches: jobs are submitted on a slot at any moment of a capture into it. Each result must be of
the frame before, of the new one, or refused, never of a mixture; the slot must hold the new frame in the end."""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import asdict, replace

import numpy as np

from golden.correlate import Job, Plane, Result, Status, run
from golden.log import kernels, sign
from golden.params import Config
from sim.board.device import Device, DeviceError
from tests.soak.case import Case, Difference, Operation, Part, config_of, seed, texture

SIGMA = 1.5
LENGTH = 25


class Races(Part):
    """See the module."""

    name = "races"

    def draw(self, rng: random.Random, config: Config) -> list[Operation]:
        size = rng.choice(((48, 36), (48, 36), (21, 19), (33, 25)))
        drawn: list[Operation] = [{"do": "configure", "size": size}]
        for _ in range(LENGTH):
            slots = rng.choice(((0, 1), (1, 0), (1, 1)))
            w, h = rng.choice(((2, 2), (16, 16), (7, 16), (9, 3)))
            job = Job(slots[0], rng.randint(0, size[0] - w), rng.randint(0, size[1] - h), w, h, slots[1], 0, 0,
                      rng.choice((1, 3, size[0] - w + 1)), rng.choice((1, 3, size[1] - h + 1)))
            # The frame's first output row leaves the filter when the row `radius` below it is complete.
            first = size[0] * (config.radius + 1) + 40
            drawn.append({"do": "race", "job": asdict(job), "count": rng.randint(1, 4), "seed": seed(rng),
                          "camera": rng.randrange(2), "other": rng.random() < 0.3, "other_seed": seed(rng),
                          "peek": rng.random() < 0.2, "pause": rng.choice((0.0, 0.0, 0.2)),
                          "wait": rng.choice((rng.randint(first - 90, first + 90), rng.randint(0, 2600)))})
        return drawn

    def play(self, case: Case) -> Counter[str]:
        config = config_of(case)
        met: Counter[str] = Counter()
        size = config.max_width, config.max_height
        planes: dict[int, Plane] = {}
        with Device(config, checked=True, power_up=case.power_up) as device:
            try:
                for operation in case.operations:
                    if operation["do"] == "configure":
                        size = operation["size"][0], operation["size"][1]
                        planes = {}
                    if not planes:
                        planes = _prepare(device, size)
                    if operation["do"] == "race":
                        planes = _race(device, operation, planes, met)
                    if device.asserted:
                        raise Difference("assertion", f"an assertion failed in {operation['do']}")
            except DeviceError as error:
                raise Difference("hang", str(error)) from error
        return met


def _prepare(device: Device, size: tuple[int, int]) -> dict[int, Plane]:
    device.set_filter(*kernels(SIGMA, device.config.radius), size)
    frames = {camera: texture(size, 5 * camera) for camera in range(2)}
    device.capture({0: 0, 1: 1}, frames)
    return {camera: sign(frame, SIGMA, device.config.radius) for camera, frame in frames.items()}


def _race(device: Device, o: Operation, planes: dict[int, Plane], met: Counter[str]) -> dict[int, Plane]:
    """One race for slot 1; returns the planes after it."""
    camera, config = o["camera"], device.config
    frame = texture(device.size, o["seed"])
    new = {**planes, 1: sign(frame, SIGMA, config.radius)}
    jobs = [replace(Job(**o["job"]), tag=tag) for tag in range(o["count"])]
    device.arm(1, camera)
    device.play(frame, camera, o["pause"], o["seed"])
    if o["other"]:  # the other camera writes a slot of its own at the same time
        other = texture(device.size, o["other_seed"])
        device.arm(2, 1 - camera)
        device.play(other, 1 - camera, o["pause"], o["other_seed"])
        new[2] = sign(other, SIGMA, config.radius)
    device.tick(o["wait"])
    device.submit(jobs)
    if o["peek"]:  # words of the slot, while it may be written: only the load matters
        device.plane(1)
        met["read back during a race"] += 1
    for job, result in zip(jobs, device.collect(len(jobs)), strict=True):
        whole = [run(job, p, config, device.size) for p in (planes, new)]
        kind = ("old frame" if result == whole[0] else "new frame" if result == whole[1] else
                "refused" if result == Result(job.tag, Status.BAD_SLOT) else "mixed")
        met[kind] += 1
        if kind == "mixed":
            raise Difference("mixed", f"{job}: {result}, which is neither {whole[0]} nor {whole[1]}")
    device.finish_playing()
    device.tick((config.radius + 2) * device.size[0] + 500)  # the frame has left the filter
    if device.read("slot_status.armed") >> camera & 1:  # the capture gave way to a job: its request waits for a frame
        met["capture gave way"] += 1
        device.play(frame, camera)
        device.finish_playing()
    device.wait_captured(0, 1)
    for slot, plane in new.items():
        if not np.array_equal(device.plane(slot), plane):
            raise Difference("plane", f"slot {slot} after a race")
    return new
