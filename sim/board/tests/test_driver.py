# SPDX-License-Identifier: Apache-2.0
"""The register driver without a board: over a recorded log of accesses, and against the register map."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from golden.correlate import Job, Result, Status, grid, run
from golden.params import TINY
from sim.board.callbacks import CallbackDriver
from sim.board.driver import DeviceError
from sim.board.structs import JOB_DTYPE, RESULT_DTYPE, pack_jobs, unpack_results
from sim.board.tests import accesses
from sim.registers.map import fields, word

HEADER = Path(__file__).parent.with_name("job.hpp")


def _logged() -> list[str]:
    return accesses.LOG.read_text().splitlines()


def _replayed(lines: list[str]) -> None:
    replay = accesses.AccessReplay(lines)
    with CallbackDriver("tiny", replay.read, replay.write) as driver:
        results, planes, counters = accesses.exercise(driver, lambda camera, frame: None)
        assert driver.outstanding == 0
    assert replay.at == len(lines)
    want = accesses.planes()
    jobs = [*accesses.JOBS, accesses.OTHER, *grid(*accesses.GRID)]
    assert results == [run(job, want, TINY, accesses.SIZE) for job in jobs]
    assert all(np.array_equal(plane, want[slot]) for slot, plane in enumerate(planes))
    good = sum(result.status is Status.OK for result in results)
    assert (counters["jobs"], counters["refused"], counters["frames[0]"]) == (good, len(jobs) - good, 1)


def test_driver_makes_the_recorded_accesses() -> None:
    """Another sequence fails at its first difference; planes and results are read from the log."""
    _replayed(_logged())


@pytest.mark.parametrize("register", ["coef", "capture", "job.tpl", "job.submit", "result.pop", "peek_address"])
def test_first_difference_is_shown(register: str) -> None:
    lines = _logged()
    at = next(k for k, line in enumerate(lines) if line.startswith(f"write {register} "))
    for changed in ([*lines[:at], *lines[at + 1:]], [*lines[:at], f"write {register} 0x0badc0de", *lines[at + 1:]]):
        assert changed[at] != lines[at]
        with pytest.raises(DeviceError, match=rf"access {at + 1} is 'write {register} .*in the log it is '"):
            _replayed(changed)


def test_log_is_what_the_board_answers() -> None:
    """The kept log is the one that the Verilated board gives today."""
    assert accesses.record() == _logged(), "record it anew: python -m sim.board.tests.accesses"


def test_structs_agree_field_by_field() -> None:
    """Names, types, order and places of `job.hpp` are those of `structs.py`."""
    for name, struct in (("SlogJob", JOB_DTYPE), ("SlogResult", RESULT_DTYPE)):
        body = re.search(rf"struct {name} {{(.*?)\n}};", HEADER.read_text(), re.DOTALL)
        assert body
        offset = 0
        members = re.findall(r"^  (\w+)_t (\w+)(?:\[(\d+)\])?;$", body[1], re.MULTILINE)
        assert [member for _, member, _ in members] == list(struct.names or ())
        for kind, member, count in members:
            base, place = struct.fields[member][:2] if struct.fields else (None, None)
            assert base == np.dtype((kind, int(count))) if count else base == np.dtype(kind), member
            assert place == offset, member
            offset += base.itemsize if base else 0
        assert offset == struct.itemsize


def test_each_field_reaches_its_register() -> None:
    """A job and a result whose fields all differ."""
    job = Job(tpl_slot=1, tpl_x=2, tpl_y=3, width=14, height=15, search_slot=6, search_x=7, search_y=8, offsets_x=9,
              offsets_y=10, tag=11, surface=True)
    count, step = (2, 3), (4, 5)
    assert dict(zip(JOB_DTYPE.names or (), pack_jobs([job], count, step)[0].tolist(), strict=True)) == {
        **vars(job), "grid_across": 2, "grid_down": 3, "step_x": 4, "step_y": 5}
    want = {"job.tpl": word("job.tpl", slot=1, x=2, y=3), "job.window": word("job.window", width=14, height=15),
            "job.search": word("job.search", slot=6, x=7, y=8), "job.offsets": word("job.offsets", across=9, down=10),
            "job.grid": word("job.grid", across=2, down=3), "job.step": word("job.step", x=4, y=5),
            "job.submit": word("job.submit", tag=11, surface=1, go=-1)}
    result = Result(21, Status.OUTSIDE, 22, 23, 24, (25, 26, 27, 28, 29, 30, 31, 32), 33)
    words = {"result.head": word("result.head", tag=21, status=-4, valid=-1),
             "result.best": word("result.best", x=22, y=23),
             "result.scores": word("result.scores", score=24, runner_up=33),
             **{f"result.neighbour[{k}]": word(f"result.neighbour[{k}]", even=25 + 2 * k, odd=26 + 2 * k)
                for k in range(4)},
             "job.status": word("job.status", ready=-1), "build_queue": word("build_queue", job_depth=8)}
    register = {field.address: name.rpartition(".")[0] for name, field in fields().items()}
    identity = accesses.AccessReplay(_logged())
    written: dict[str, int] = {}

    def read(where: int) -> int:
        return words[register[where]] if register[where] in words else identity.read(where)

    def write(where: int, value: int) -> None:
        written[register[where]] = value
        if register[where] == "irq_enable":
            identity.at = 2  # past the two accesses of the start
        if register[where] == "result.pop":
            words["result.head"] = 0

    with CallbackDriver("tiny", read, write) as driver:
        driver.submit_grid(job, count, step)
        assert {name: written[name] for name in want} == want
        assert driver.outstanding == 6
        assert driver.collect(1) == [result] and driver.outstanding == 5
    row = np.zeros(1, RESULT_DTYPE)
    row["neighbours"] = result.neighbours
    for name in set(RESULT_DTYPE.names or ()) - {"neighbours"}:
        row[name] = getattr(result, name)
    unpacked = unpack_results(row)
    assert unpacked == [result] and {type(n) for n in unpacked[0].neighbours} == {int}


def test_an_access_that_raises_ends_the_call() -> None:
    replay = accesses.AccessReplay(_logged())
    broken: list[int] = []

    def read(where: int) -> int:
        if broken:
            raise OSError("cable")
        return replay.read(where)

    with CallbackDriver("tiny", read, replay.write) as driver:
        broken.append(1)
        with pytest.raises(DeviceError, match="capture: cable") as caught:
            driver.wait_captured(0)
        assert isinstance(caught.value.__cause__, OSError)
