# SPDX-License-Identifier: Apache-2.0
"""Fetch, store and sequencer models in a loop, with stalls: the correlator up to the operands of its array."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import repeat

from golden.correlate import Job, Plane
from golden.cycle.array.timing import drain_clocks
from golden.cycle.bits import all_or_zero
from golden.cycle.correlator.fetch import FetchModel
from golden.cycle.correlator.sequencer import SequencerModel
from golden.cycle.model import Values
from golden.params import Config
from golden.structs import CONTEXT, STEP, pack_job
from golden.traffic.replay import Replay
from golden.traffic.store import filled_store, read_store


class FetchLoop:
    """The models in a loop. `contexts` collects those for the peak unit, `replay` gets the inputs of the array."""

    def __init__(self, config: Config, planes: dict[int, Plane]) -> None:
        self.config = config
        height, width = next(iter(planes.values())).shape
        self.fixed = {"rst_i": 0, "image_width_i": width, "image_height_i": height,
                      "slot_valid_i": sum(1 << s for s in planes)}
        self.fetch = FetchModel(config)
        self.store = filled_store(config, planes)
        self.sequencer = SequencerModel(config.group_bits, config.pitch, config.ring_rows,
                                        drain_clocks(config.group_bits, config.lanes))
        self.replay = Replay(config)
        self.contexts: list[dict[str, int]] = []
        self.granted = 0
        self.clocks = 0

    def run(self, jobs: Sequence[Job], source: Iterator[int] | None = None, context: Iterator[int] | None = None,
            grant: Iterator[int] | None = None, limit: int = 200_000,
            observe: Callable[[Values], None] | None = None) -> int:
        """Run `jobs` to their last step; the iterators hold whether each end is ready in a clock (default: always).

        Returns:
            Clocks taken.

        Raises:
            AssertionError: if the models do not finish in `limit` clocks, or break the schedule's contract.
        """
        offer, take, allow = (i or repeat(1) for i in (source, context, grant))
        waiting = [pack_job(j) for j in jobs]
        start = self.clocks
        offered = False
        while True:
            assert self.clocks - start < limit, "the jobs never end"
            offered = bool(waiting) and (offered or bool(next(offer)))
            ctx_ready, row_ready = next(take), next(allow)
            seq, walker = self.sequencer, self.sequencer.walker
            stored = self.store.data
            f = self.fetch.step({
                **self.fixed, "job_valid_i": int(offered), "job_i": waiting[0] if waiting else 0,
                "rd_data_i": stored or 0, "ticket_ready_i": int(seq.state == "idle"), "rows_freed_i": walker.freed,
                "bank_free_i": walker.bank_free})
            now = all_or_zero(f)
            read_store(self.store, now)
            s = seq.step({"rst_i": 0, "ticket_valid_i": now["ticket_valid_o"], "ticket_i": now["ticket_o"],
                          "tpl_done_i": now["tpl_done_o"], "rows_written_i": now["rows_written_o"],
                          "ctx_ready_i": ctx_ready, "row_ready_i": row_ready})
            if offered and now["job_ready_o"]:
                waiting.pop(0)
                offered = False
            if s["ctx_valid_o"] and ctx_ready:
                assert s["ctx_o"] is not None
                self.contexts.append(CONTEXT.unpack(s["ctx_o"]))
            if s["row_valid_o"] and row_ready:
                self.granted += 1
            step = None
            if s["step_valid_o"]:
                assert s["step_o"] is not None
                step = STEP.unpack(s["step_o"])
            write = None
            if now["wr_valid_o"]:
                write = {k: now[f"wr_{k}_o"] for k in ("tpl", "wide", "bank", "row", "word", "data")}
            self.replay.step(write, step, s["mask_o"])
            if observe:
                observe(s)
            self.clocks += 1
            if not waiting and not now["busy_o"] and not s["busy_o"]:
                return self.clocks - start
