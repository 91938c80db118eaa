"""What surrounds the correlator, for its tests: a source of jobs, the bit-plane store, a host that takes answers.

`CorrelatorTraffic.stimulus` drives the cycle model alone or, in cocotb, model and RTL alike.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import repeat

import numpy as np

from golden.correlate import Job, Plane, Result, Status, run, surface
from golden.cycle.store.store import StoreModel
from golden.params import Config
from golden.structs import RESULT, pack_job
from golden.traffic.fetch_loop import store_words


def packed_result(result: Result) -> int:
    """`result` as a packed `result_t`."""
    return RESULT.pack({"tag": result.tag, "status": result.status, "best_x": result.best_x, "best_y": result.best_y,
                        "score": result.score, "runner_up": result.runner_up,
                        **{f"neighbour{k}": v for k, v in enumerate(result.neighbours)}})


@dataclass
class CorrelatorTraffic:
    """Jobs in, answers out. `planes` are the frames by slot, all of one size."""

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
    last_score: int = 0

    def stimulus(self) -> Generator[dict[str, int], Mapping[str, int | None], None]:
        """Runs all jobs to their results, and some clocks more. A reset starts the jobs over.

        Raises:
            AssertionError: if the results never come, or an offered word changes while it waits.
        """
        c = self.config
        height, width = next(iter(self.planes.values())).shape
        store = StoreModel(c.store_words)
        for slot, plane in self.planes.items():
            store.memory[slot * c.slot_words:(slot + 1) * c.slot_words] = store_words(plane, c)
        sent, offered, quiet = 0, False, 0
        while quiet < 80:
            assert self.clocks < self.limit, f"{len(self.results)} results of {len(self.jobs)} jobs"
            offered = sent < len(self.jobs) and (offered or bool(next(self.source)))
            reset = int(self.clocks == self.reset_at)
            res_ready, surf_ready = next(self.results_end), next(self.surface_end)
            out = yield {"rst_i": reset, "job_valid_i": int(offered),
                         "job_i": pack_job(self.jobs[sent]) if offered else 0, "image_width_i": width,
                         "image_height_i": height,
                         "slot_valid_i": sum(1 << s for s in self.planes), "rd_data_i": store.data or 0,
                         "res_ready_i": res_ready, "surf_tready_i": surf_ready}
            store.step({"rst_i": 0, "wr_valid_i": 0, "wr_addr_i": 0, "wr_data_i": 0, "peek_valid_i": 0,
                        "peek_addr_i": 0, "rd_valid_i": out["rd_valid_o"] or 0, "rd_addr_i": out["rd_addr_o"] or 0})
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
            assert RESULT.unpack(seen) == RESULT.unpack(packed_result(result)), job
        stream = []
        for job, result in zip(self.jobs, wanted, strict=True):
            if job.surface and result.status is Status.OK:
                scores = surface(self.planes[job.tpl_slot], self.planes[job.search_slot], job).ravel().tolist()
                stream += [(s, int(k == 0), int(k == len(scores) - 1)) for k, s in enumerate(scores)]
        assert self.stream == stream



def random_planes(config: Config, slots: tuple[int, ...], seed: int, repeats: int = 1) -> dict[int, Plane]:
    """Random planes; with `repeats` > 1 they repeat themselves, which makes equal scores."""
    rng = np.random.default_rng(seed)
    shape = (config.max_height, config.max_width)
    tile = tuple(-(-n // repeats) for n in shape)
    return {s: np.tile(rng.integers(0, 2, tile, dtype=np.uint8), (repeats, repeats))[:shape[0], :shape[1]]
            for s in slots}
