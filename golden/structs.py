# SPDX-License-Identifier: Apache-2.0
"""Packed structs of rtl/slog_pkg.sv and rtl/correlator/slog_fetch_pkg.sv as Python layouts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict

from golden.correlate import Job, Result


class Layout:
    """A packed struct: (name, bits) pairs from the most significant field down; `bits` is their sum."""

    def __init__(self, *fields: tuple[str, int]) -> None:
        self.fields = fields
        self.bits = sum(bits for _, bits in fields)

    def pack(self, values: Mapping[str, int]) -> int:
        """The struct as one integer; values of other names are ignored.

        Raises:
            KeyError: if a field has no value.
            ValueError: if a value does not fit its field.
        """
        word = 0
        for name, bits in self.fields:
            value = int(values[name])
            if not 0 <= value < 1 << bits:
                raise ValueError(f"{name} = {value} does not fit {bits} bits")
            word = word << bits | value
        return word

    def unpack(self, word: int) -> dict[str, int]:
        """Field values of a packed struct."""
        values = {}
        for name, bits in reversed(self.fields):
            values[name] = word & (1 << bits) - 1
            word >>= bits
        return values


JOB = Layout(("tag", 16), ("surface", 1), ("tpl_slot", 3), ("tpl_x", 10), ("tpl_y", 10), ("width", 8), ("height", 8),
             ("search_slot", 3), ("search_x", 10), ("search_y", 10), ("offsets_x", 10), ("offsets_y", 10))
CONTEXT = Layout(("tag", 16), ("surface", 1), ("status", 3), ("offsets_x", 10), ("offsets_y", 10), ("area", 15))
STEP = Layout(("valid", 1), ("first", 1), ("last", 1), ("wide", 1), ("row_b", 1), ("bank", 1), ("tpl_step", 7),
              ("ring_row", 8), ("chunk", 5), ("lanes", 6))
RESULT = Layout(("tag", 16), ("status", 3), ("best_x", 10), ("best_y", 10), ("score", 15),
                *((f"neighbour{k}", 15) for k in range(7, -1, -1)), ("runner_up", 15))
LOAD = Layout(("addr", 16), ("shift", 6), ("words_in", 4), ("words_out", 4), ("rows", 10))
TICKET = Layout(("job", JOB.bits), ("status", 3), ("bank", 1), ("row", 9), ("area", 15))
STEP_ROW = Layout(("final_row", 1), ("bank", 1), ("wide", 1), ("odd", 1), ("steps", 8), ("ring_row", 8), ("passes", 6),
             ("last_lanes", 6), ("gap_row", 7), ("gap_pass", 7), ("free_to", 9))
"""`row_t`: a row of offsets, as the walker turns it into steps."""


def pack_job(job: Job) -> int:
    """`job` as a packed `job_t`."""
    return JOB.pack({name: int(value) for name, value in asdict(job).items()})


def unpack_job(word: int) -> Job:
    """The job in a packed `job_t`."""
    fields = JOB.unpack(word)
    return Job(**{**fields, "surface": bool(fields["surface"])})  # type: ignore[arg-type]


def pack_result(result: Result) -> int:
    """`result` as a packed `result_t`."""
    return RESULT.pack({"tag": result.tag, "status": result.status, "best_x": result.best_x, "best_y": result.best_y,
                        "score": result.score, "runner_up": result.runner_up,
                        **{f"neighbour{k}": v for k, v in enumerate(result.neighbours)}})
