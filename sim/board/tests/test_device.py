# SPDX-License-Identifier: Apache-2.0
"""The Verilated board, both configurations, against the frame level: identical bits."""

from __future__ import annotations

import random
import time
from collections.abc import Iterator

import numpy as np
import pytest
from skimage import data

from golden import log
from golden.correlate import Job, Plane, Status, grid, run, surface
from golden.log import Image
from golden.params import FULL, TINY, Config
from sim.board import build as builder
from sim.board.device import Device, DeviceError, DeviceTimeout, frame_beats
from sim.toolchain import rtl_sources


@pytest.fixture(scope="module")
def tiny() -> Iterator[Device]:
    with Device("tiny") as device:
        yield device


@pytest.fixture(scope="module")
def full() -> Iterator[Device]:
    with Device("full") as device:
        yield device


def noise(rng: random.Random, size: tuple[int, int]) -> Image:
    """Smooth and rough patches side by side, so that responses of exactly 0 occur."""
    source = np.random.default_rng(rng.getrandbits(32))
    image = source.integers(0, 256, (size[1], size[0]), dtype=np.uint8)
    image[: size[1] // 3, : size[0] // 2] //= 128
    image[-size[1] // 4:, size[0] // 2:] = 77
    return image


def set_up(device: Device, sigma: float, size: tuple[int, int]) -> None:
    device.set_filter(*log.kernels(sigma, device.config.radius), size)


def any_job(rng: random.Random, config: Config, size: tuple[int, int], tag: int, slots: int, most: int) -> Job:
    """A job that is nearly always good, with at most `most` offsets each way."""
    width, height = (rng.randint(config.min_window, config.max_window) for _ in range(2))
    width, height = min(width, size[0]), min(height, size[1])
    across, down = rng.randint(1, min(most, size[0] - width + 1)), rng.randint(1, min(most, size[1] - height + 1))
    return Job(rng.randrange(slots), rng.randint(0, size[0] - width), rng.randint(0, size[1] - height), width, height,
               rng.randrange(slots), rng.randint(0, size[0] - width - across + 1),
               rng.randint(0, size[1] - height - down + 1) + (rng.random() < 0.1), across, down, tag,
               rng.random() < 0.3)


def hold_to_golden(device: Device, jobs: list[Job], planes: dict[int, Plane]) -> int:
    """Results and surfaces of submitted jobs; returns the number of accepted ones."""
    results = device.collect(len(jobs))
    good = 0
    for job, result in zip(jobs, results, strict=True):
        assert result == run(job, planes, device.config, device.size), job
        if result.status is Status.OK:
            good += 1
            if job.surface:
                want = surface(planes[job.tpl_slot], planes[job.search_slot], job)
                assert np.array_equal(device.surface(want.size), want.flatten()), job
    assert device.stream_waiting == 0 and device.outstanding == 0
    return good


@pytest.mark.slow  # the first of them builds the board
@pytest.mark.parametrize("size", [(48, 36), (18, 18), (33, 25), (41, 19)])
@pytest.mark.parametrize("sigma", [1.0, 2.3, 4.0])
def test_tiny_planes(tiny: Device, size: tuple[int, int], sigma: float) -> None:
    """Both cameras at once, any size, with and without pauses."""
    rng = random.Random(f"{size}{sigma}")
    set_up(tiny, sigma, size)
    for pause in (0.0, 0.4):
        frames = {camera: noise(rng, size) for camera in range(TINY.cameras)}
        slots = {0: rng.randrange(3), 1: rng.randrange(3, 6)}
        tiny.capture(slots, frames, pause, rng.getrandbits(16))
        for camera, slot in slots.items():
            want = log.sign(frames[camera], sigma, TINY.radius)
            assert np.array_equal(tiny.plane(slot), want) and 0 < want.mean() < 1


@pytest.mark.parametrize("pause", [0.0, 0.5, 0.95])
def test_tiny_jobs(tiny: Device, pause: float) -> None:
    """Jobs of every kind, far more than the queues hold, with a receiver of the surface that often holds it back."""
    rng = random.Random(f"jobs{pause}")
    size = 45, 33
    set_up(tiny, 1.3, size)
    frames = [noise(rng, size) for _ in range(2)]
    tiny.capture({0: 0, 1: 1}, dict(enumerate(frames)))
    planes = {k: log.sign(f, 1.3, TINY.radius) for k, f in enumerate(frames)}
    before = tiny.counters()
    tiny.pause_stream(pause)
    jobs = [any_job(rng, TINY, size, tag, 3, 9) for tag in range(150)]
    tiny.submit(jobs)
    assert tiny.outstanding == len(jobs)
    good = hold_to_golden(tiny, jobs, planes)
    tiny.pause_stream(0.0)
    assert 40 < good < 150
    after = tiny.counters()
    assert after["jobs"] - before["jobs"] == good and after["refused"] - before["refused"] == len(jobs) - good
    assert after["overflows"] == before["overflows"]


def test_a_closed_board_says_so() -> None:
    device = Device("tiny")
    device.close()
    device.close()
    for call in (lambda: device.clocks, device.counters, device.reset, lambda: device.tick(1)):
        with pytest.raises(DeviceError, match="the board is closed"):
            call()


def test_tiny_grid(tiny: Device) -> None:
    """One command, many jobs; the last column runs off the image."""
    rng = random.Random(5)
    set_up(tiny, 1.3, (48, 36))
    frame = noise(rng, (48, 36))
    tiny.capture({0: 2}, {0: frame})
    job = Job(2, 0, 0, 10, 9, 2, 0, 1, 4, 3, tag=65530)
    tiny.submit_grid(job, (7, 4), (6, 5))
    jobs = grid(job, (7, 4), (6, 5))
    good = hold_to_golden(tiny, jobs, {2: log.sign(frame, 1.3, TINY.radius)})
    assert 0 < good < len(jobs) == 28


def test_tiny_capture_during_jobs(tiny: Device) -> None:
    """Frames stream into one slot while jobs work on others, and the slot is used as soon as it is valid."""
    rng = random.Random(6)
    size = 48, 36
    set_up(tiny, 2.0, size)
    frames = [noise(rng, size) for _ in range(6)]
    planes = [log.sign(f, 2.0, TINY.radius) for f in frames]
    tiny.capture({0: 0, 1: 1}, {0: frames[0], 1: frames[1]})
    for k in range(2, 6):
        jobs = [any_job(rng, TINY, size, tag, 2, 8) for tag in range(25)]
        tiny.submit(jobs)
        tiny.capture({k % 2: k}, {k % 2: frames[k]}, pause=0.1)
        late = [Job(k, 3, 4, 9, 8, k - 1, 1, 2, 9, 7, 99)]
        tiny.submit(late)
        hold_to_golden(tiny, jobs + late, dict(enumerate(planes[:k + 1])))


def test_tiny_bad_frames(tiny: Device) -> None:
    """Broken frames are dropped and reported; the next good frame is right."""
    rng = random.Random(7)
    size = 30, 22
    set_up(tiny, 1.5, size)
    frame = noise(rng, size)
    want = log.sign(frame, 1.5, TINY.radius)
    beats = frame_beats(frame)
    broken = [beats[:size[0] * 9], np.delete(beats, 40), np.insert(beats, 100, 7), beats[:200]]
    for kind, bad in enumerate(broken):
        drops = tiny.counters()["drops[0]"]
        tiny.arm(kind, 0)
        tiny.play_beats(np.concatenate([bad, beats]))
        tiny.finish_playing()
        tiny.wait_captured(0)
        assert np.array_equal(tiny.plane(kind), want)
        assert tiny.counters()["drops[0]"] > drops
    with pytest.raises(DeviceError, match="dropped the frame of camera 1"):
        tiny.capture({1: 5}, {1: noise(rng, (size[0] + 1, size[1]))})
    assert not tiny.read("slot_status.armed")
    tiny.capture({1: 5}, {1: frame})
    assert np.array_equal(tiny.plane(5), want)


def test_tiny_errors(tiny: Device) -> None:
    """A frame that never arrives, a slot that does not exist, a size that does not fit: each its own error."""
    set_up(tiny, 1.5, (30, 22))
    tiny.arm(0)
    with pytest.raises(DeviceTimeout, match=r"capture: no progress .*slot_status.armed 0x1"):
        tiny.wait_captured(0)
    with pytest.raises(DeviceError, match="refuses to capture camera 1 into slot 0"):
        tiny.arm(0, camera=1)
    with pytest.raises(DeviceError, match="refuses to capture camera 0 into slot 6"):
        tiny.arm(6)
    with pytest.raises(DeviceError, match="refuses images of 17x22"):
        set_up(tiny, 1.5, (17, 22))
    assert tiny.size == (30, 22)
    with pytest.raises(ValueError, match="kernels need 9"):
        tiny.set_filter([1], [1])
    tiny.reset()
    assert tiny.read("slot_status.armed") == 0 and tiny.size == (48, 36)
    with pytest.raises(DeviceTimeout, match="collecting 1 results"):
        tiny.collect(1)


def test_full_frames_and_jobs(full: Device) -> None:
    """Real pictures through both cameras at once; windows of every size; a whole-frame search with its surface."""
    size, sigma = (FULL.max_width, FULL.max_height), 2.5
    pictures = [np.ascontiguousarray(p) for p in (data.gravel()[:480, :512], data.brick()[:480, :512])]
    frames = [np.ascontiguousarray(np.hstack([p, p[:, :128]])) for p in pictures]
    frames.append(np.ascontiguousarray(np.roll(frames[0], (3, -5), (0, 1))))
    set_up(full, sigma, size)
    full.capture({0: 0, 1: 5}, {0: frames[0], 1: frames[1]})
    full.capture({0: 2}, {0: frames[2]})
    planes = {slot: log.sign(frames[k], sigma) for k, slot in enumerate((0, 5, 2))}
    for slot, plane in planes.items():
        assert np.array_equal(full.plane(slot), plane)
    rng = random.Random(11)
    jobs = [Job(0, 200 + k, 150, 64, 64, 2, 168 + k, 118, 65, 65, k) for k in range(4)]
    jobs += [Job(0, 300, 200, w, h, 2, 280, 190, 33, 17, 10 + w, surface=True)
             for w, h in ((8, 8), (63, 21), (65, 64), (100, 37), (128, 128), (127, 9))]
    jobs += [any_job(rng, FULL, size, 300 + k, 6, 40) for k in range(12)]
    jobs.append(Job(5, 600, 440, 40, 40, 5, 0, 0, 601, 441, 999, surface=True))
    full.submit(jobs)
    assert hold_to_golden(full, jobs, planes) >= 12


def test_full_utilisation(full: Device) -> None:
    """At least nine of ten clocks of +-32 searches of 64x64 windows yield a score, loading included."""
    picture = np.ascontiguousarray(data.gravel()[:480, :512])
    set_up(full, 2.0, (512, 480))
    full.capture({0: 0}, {0: picture})
    full.capture({0: 2}, {0: picture})
    before = full.counters()
    full.submit([Job(0, 100 + 9 * k, 80 + 7 * k, 64, 64, 2, 68 + 9 * k, 48 + 7 * k, 65, 65, k) for k in range(12)])
    assert all(r.status is Status.OK for r in full.collect(12))
    after = full.counters()
    scores, busy = (after[n] - before[n] for n in ("scores", "busy"))
    assert scores == 12 * 65 * 65
    assert scores >= 0.9 * busy, f"{scores / busy:.3f} of the clocks"


def test_build_is_current() -> None:
    """A current library is not built again, and the digest sees flags and sources."""
    first = builder.build("tiny")
    start, made = time.monotonic(), first.stat().st_mtime_ns
    assert builder.build("tiny") == first and first.stat().st_mtime_ns == made
    assert time.monotonic() - start < 5
    sources = rtl_sources("tiny")
    digests = {builder._digest(sources, []), builder._digest(sources, ["-x"]), builder._digest(sources[1:], []),
               builder._digest(rtl_sources("full"), [])}
    assert len(digests) == 4
