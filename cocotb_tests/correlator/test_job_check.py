# SPDX-License-Identifier: Apache-2.0
"""`slog_job_check` at full size against its cycle model on every clock."""

import random
from collections import Counter
from dataclasses import replace
from typing import Any

import cocotb

from cocotb_tests.env.check import check_cycles
from golden.correlate import COORDINATE_MAX, Job, Status
from golden.cycle.correlator.job_check import CHECK_LATENCY, JobCheckModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import FULL
from golden.structs import JOB, pack_job
from golden.traffic.jobs import acceptable, mixed
from sim.coverage.record import met
from sim.testbench.runner import simulate

VALID = [True, False, True, True, False, True, True, True]
"""Slots that `slot_valid_i` names: among them 6 and 7, which the board does not have."""
COORDINATES = "tpl_x", "tpl_y", "search_x", "search_y", "offsets_x", "offsets_y"


def _far() -> list[Job]:
    """Jobs that reach so far outside that a sum with its top bit lost would lie inside the image: each axis and end."""
    jobs = []
    for axis, side in (("x", "width"), ("y", "height")):
        for window in (FULL.min_window, 100, FULL.max_window):
            inside = Job(0, 0, 0, FULL.min_window, FULL.min_window, 2, 0, 0, 1, 1)
            for far in ((f"tpl_{axis}",), (f"search_{axis}",), (f"offsets_{axis}",),
                        (f"search_{axis}", f"offsets_{axis}")):
                values: dict[str, Any] = {side: window, **dict.fromkeys(far, COORDINATE_MAX)}
                jobs.append(replace(inside, **values))
    return jobs


def _no_such_slot() -> list[Job]:
    """Jobs that are good but for a slot this board does not have."""
    return [Job(tpl, 0, 0, FULL.min_window, FULL.min_window, search, 0, 0, 2, 2)
            for slot in range(FULL.slots, 8) for tpl, search in ((slot, 0), (0, slot))]


def _jobs(rng: random.Random, jobs: list[int], sizes: list[tuple[int, int]], resets: bool) -> Stimulus:
    """Job after job, at once or after a pause; `slot_valid_i` changes as soon as it is no longer needed.

    With `resets`, every fifth job is cut by one, and then begins again: every job is answered once."""
    valid = sum(1 << s for s in range(8) if VALID[s])
    for n, (job, size) in enumerate(zip(jobs, sizes, strict=True)):
        fixed = {"job_i": job, "image_width_i": size[0], "image_height_i": size[1]}
        for cut in (True, False) if resets and n % 5 == 4 else (False,):
            yield {**fixed, "rst_i": 0, "start_i": 1, "slot_valid_i": valid}
            for t in range(CHECK_LATENCY + rng.choice((0, 0, 3))):
                yield {**fixed, "rst_i": int(cut and t == 4), "start_i": 0, "slot_valid_i": rng.getrandbits(8)}


@cocotb.test()
@cocotb.parametrize(resets=[False, True])
async def every_clock(dut, resets: bool) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    config = FULL
    size = (config.max_width - 3, config.max_height - 1)
    jobs = [pack_job(j) for j in mixed(rng, config, size, VALID, 120)]
    jobs += [rng.getrandbits(JOB.bits) for _ in range(40)]
    # Exactly at the edge of the image, and each limit by itself one beyond.
    base = acceptable(rng, config, size)
    w, h = base.width, base.height
    fit = JOB.unpack(pack_job(Job(0, size[0] - w, size[1] - h, w, h, 2, size[0] - w - 1, size[1] - h - 1, 2, 2)))
    jobs.append(JOB.pack(fit))
    jobs += [JOB.pack({**fit, name: fit[name] + 1})
             for name in ("tpl_x", "tpl_y", "search_x", "search_y", "offsets_x", "offsets_y")]
    jobs += map(pack_job, (*_far(), *_no_such_slot()))
    sizes = [size] * len(jobs)
    # Other images, among them the largest and the smallest: a window of the smallest size at the last place that fits.
    lo = config.min_window
    for n in range(40):
        w, h = [(config.max_width, config.max_height), (config.min_image, config.min_image)][n % 2] if n % 4 < 2 else (
            rng.randint(config.min_image, config.max_width), rng.randint(config.min_image, config.max_height))
        sizes.append((w, h))
        jobs.append(pack_job(Job(0, w - lo, h - lo, lo, lo, 2, w - lo - n % 3, h - lo - n // 3 % 3, 2, 2)))
    seen: Counter[Status] = Counter()

    def count(_i: Inputs, out: Outputs) -> None:
        if out["done_o"]:
            assert out["status_o"] is not None
            seen[Status(out["status_o"])] += 1

    await check_cycles(dut, JobCheckModel(config), _jobs(rng, jobs, sizes, resets), count)
    met("job statuses", {status.name: count for status, count in seen.items()})
    fields = [JOB.unpack(job) for job in jobs]
    met("extreme coordinates", {f"{name} {extreme}": sum(job[name] == extreme for job in fields)
                                for name in COORDINATES for extreme in (0, COORDINATE_MAX)})
    assert sum(seen.values()) == len(jobs)
    assert all(seen[s] >= 5 for s in Status)


def test_job_check() -> None:
    simulate("slog_job_check", __name__,
             {"MinWindow": FULL.min_window, "MaxWindow": FULL.max_window, "Slots": FULL.slots})
