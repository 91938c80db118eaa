# SPDX-License-Identifier: Apache-2.0
"""The surroundings of the correlator for its tests: a source of jobs, the bit-plane store, a host that takes results.

`CorrelatorTraffic.stimulus` drives the cycle model alone or, in cocotb, model and RTL together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import repeat

import numpy as np

from golden.correlate import Job, Plane, Status, run, surface
from golden.cycle.bits import or_zero
from golden.cycle.model import Stimulus
from golden.params import Config
from golden.structs import RESULT, pack_job, pack_result
from golden.traffic.peak import surface_beats
from golden.traffic.store import filled_store, read_store


@dataclass
class CorrelatorTraffic:
    """Jobs in, results and surfaces out. `planes` are the sign planes by slot, all of one size.

    `source`, `results_end` and `surface_end` hold whether that end is ready in a clock; `reset_at` is the clock of a
    reset, `limit` the clocks allowed.
    """

    config: Config
    planes: Mapping[int, Plane]
    jobs: Sequence[Job]
    source: Iterator[int] = field(default_factory=lambda: repeat(1))
    results_end: Iterator[int] = field(default_factory=lambda: repeat(1))
    surface_end: Iterator[int] = field(default_factory=lambda: repeat(1))
    reset_at: int | None = None
    limit: int = 60_000
    results: list[int] = field(default_factory=list)
    stream: list[tuple[int, int, int]] = field(default_factory=list)
    clocks: int = 0
    scores: int = 0
    first_score: int | None = None
    """Clock of the first score; None before it."""
    last_score: int = 0
    """Clock of the last score so far."""

    def stimulus(self) -> Stimulus:
        """Run all jobs to their results, and 80 clocks more. After a reset the jobs begin again.

        Raises:
            AssertionError: if that takes more than `limit` clocks.
        """
        height, width = next(iter(self.planes.values())).shape
        store = filled_store(self.config, self.planes)
        sent, offered, quiet = 0, False, 0
        while quiet < 80:
            assert self.clocks < self.limit, f"{len(self.results)} results of {len(self.jobs)} jobs"
            offered = sent < len(self.jobs) and (offered or bool(next(self.source)))
            reset = int(self.clocks == self.reset_at)
            res_ready, surf_ready = next(self.results_end), next(self.surface_end)
            out = yield {"rst_i": reset, "job_valid_i": int(offered),
                         "job_i": pack_job(self.jobs[sent]) if offered else 0, "image_width_i": width,
                         "image_height_i": height, "slot_valid_i": sum(1 << s for s in self.planes),
                         "rd_data_i": or_zero(store.data), "res_ready_i": res_ready, "surf_tready_i": surf_ready}
            read_store(store, out)
            if reset:
                sent, offered = 0, False
                self.results.clear()
                self.stream.clear()
            else:
                if offered and out["job_ready_o"]:
                    sent, offered = sent + 1, False
                if out["res_valid_o"] and res_ready:
                    self.results.append(out["res_o"] or 0)
                if out["surf_tvalid_o"] and surf_ready:
                    self.stream.append((out["surf_tdata_o"] or 0, out["surf_tuser_o"] or 0, out["surf_tlast_o"] or 0))
                if out["score_o"]:
                    self.scores += 1
                    self.last_score = self.clocks
                    if self.first_score is None:
                        self.first_score = self.clocks
            self.clocks += 1
            quiet = quiet + 1 if len(self.results) >= len(self.jobs) and not out["surf_tvalid_o"] else 0

    def check(self) -> None:
        """Results and surfaces against the frame level.

        Raises:
            AssertionError: naming the first job that differs.
        """
        size = next(iter(self.planes.values())).shape[::-1]
        wanted = [run(job, self.planes, self.config, size) for job in self.jobs]
        assert len(self.results) == len(wanted)
        for job, seen, result in zip(self.jobs, self.results, wanted, strict=True):
            assert RESULT.unpack(seen) == RESULT.unpack(pack_result(result)), job
        stream = []
        for job, result in zip(self.jobs, wanted, strict=True):
            if job.surface and result.status is Status.OK:
                stream += surface_beats(surface(self.planes[job.tpl_slot], self.planes[job.search_slot], job))
        assert self.stream == stream


def random_planes(config: Config, slots: Sequence[int], seed: int, repeats: int = 1,
                  size: tuple[int, int] | None = None) -> dict[int, Plane]:
    """Random sign planes for `slots`, uint8 0/1, (H, W) of `size` (width, height) or the largest image.

    With `repeats` > 1 a tile is repeated that often across and down, which makes equal scores.
    """
    rng = np.random.default_rng(seed)
    shape = size[::-1] if size else (config.max_height, config.max_width)
    tile = tuple(-(-n // repeats) for n in shape)
    return {s: np.tile(rng.integers(0, 2, tile, dtype=np.uint8), (repeats, repeats))[:shape[0], :shape[1]]
            for s in slots}
