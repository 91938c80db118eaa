# SPDX-License-Identifier: Apache-2.0
"""Lockstep of the golden and the Verilated board: the same calls, good and bad ones, must have the same answers."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np

from golden.correlate import COORDINATE_MAX, Job, Status
from golden.params import MAX_SIGMA, MIN_SIGMA, Config
from signum.boards.board import Board, BoardError
from signum.boards.golden import GoldenBoard
from signum.boards.verilated import VerilatedBoard
from tests.soak.case import Case, Difference, Operation, Part, config_of, extreme, seed, texture

LENGTH = {"tiny": 80, "full": 14}
"""Operations of a case."""
MOST_WORK = {"tiny": 1 << 20, "full": 400_000}
"""Largest product of a job's offsets and window rows."""
NOT_COMPARED = {"clocks", "busy_clocks"}
"""Counters that the golden board estimates."""


class Boards(Part):
    """See the module."""

    name = "boards"
    configs = ("tiny", "tiny", "tiny", "full")

    def draw(self, rng: random.Random, config: Config) -> list[Operation]:
        size = config.max_width, config.max_height
        drawn: list[Operation] = [{"do": "configure", "size": size, "sigma": 1.5}]
        for slot in range(3):
            drawn.append({"do": "capture", "slots": [slot], "camera": slot % 2, "seeds": [seed(rng)]})
        for tag in range(LENGTH[config.name]):
            operation, new_size = _operation(rng, config, size, 64 * tag)
            if operation["do"] == "configure" and rng.random() < 0.7:
                drawn.append({"do": "collect", "count": 1 << 20})
            drawn.append(operation)
            if new_size != size and rng.random() < 0.8:
                drawn += [{"do": "capture", "slots": [slot], "camera": slot % 2, "seeds": [seed(rng)]}
                          for slot in range(3)]
            size = new_size
        return drawn

    def play(self, case: Case) -> Counter[str]:
        config = config_of(case)
        met: Counter[str] = Counter()
        with GoldenBoard(config) as golden, VerilatedBoard(config, checked=True, power_up=case.power_up) as verilated:
            for operation in (*case.operations, {"do": "finish"}):
                answers = [_answer(board, operation) for board in (golden, verilated)]
                if answers[0] != answers[1]:
                    golden_s, verilated_s = _where_they_differ(*answers)
                    raise Difference(operation["do"], f"golden {golden_s}, Verilated {verilated_s}"[:1000])
                if verilated.asserted:
                    raise Difference("assertion", f"an assertion failed in {operation['do']}")
                _count(met, config, golden, operation, answers[0])
        return met


def _where_they_differ(one: Any, other: Any) -> tuple[Any, Any]:
    """The first elements that differ, of two sequences within sequences; or the two themselves."""
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)) and len(one) == len(other):
        for a, b in zip(one, other, strict=True):
            if a != b:
                return _where_they_differ(a, b)
    return one, other


def _operation(rng: random.Random, config: Config, size: tuple[int, int],
               tag: int) -> tuple[Operation, tuple[int, int]]:
    """An operation, and the image size after it if it is the first of its kind."""
    kind = rng.choices(("configure", "capture", "plane", "submit", "grid", "collect", "surface", "counters"),
                       (8, 20, 10, 30, 8, 15, 6, 3))[0]
    if kind == "configure":
        if rng.random() < 0.5:
            size = (extreme(rng, config.min_image - 1, config.max_width + 1),
                    extreme(rng, config.min_image - 1, config.max_height + 1))
        sigma = rng.choice((MIN_SIGMA, MAX_SIGMA, round(rng.uniform(MIN_SIGMA - 0.1, MAX_SIGMA + 0.1), 3)))
        limited = tuple(min(max(s, config.min_image), most)
                        for s, most in zip(size, (config.max_width, config.max_height), strict=True))
        return {"do": kind, "size": size, "sigma": sigma}, (limited[0], limited[1])
    if kind == "capture":
        slots = rng.sample(range(config.slots), rng.choice((1, 1, 2)))
        return {"do": kind, "slots": slots, "camera": rng.randrange(2), "seeds": [seed(rng) for _ in slots]}, size
    if kind == "plane":
        return {"do": kind, "slot": rng.randrange(config.slots)}, size
    if kind == "submit":
        jobs = [_job(rng, config, size, tag + k) for k in range(rng.choice((1, 1, 3, 20)))]
        return {"do": kind, "jobs": [asdict(job) for job in (jobs if config.name == "tiny" else jobs[:3])]}, size
    if kind == "grid":
        job, count = _job(rng, config, size, tag), (rng.choice((1, 2, 7)), rng.choice((1, 3)))
        if config.name != "tiny":
            count = (1, 2)
        return {"do": kind, "job": asdict(job), "count": count,
                "step": (rng.choice((0, 1, 5, 1023)), rng.choice((0, 1, 7, 1023)))}, size
    if kind == "surface":
        return {"do": kind, "job": asdict(_job(rng, config, size, tag))}, size
    return ({"do": kind, "count": rng.randint(1, 40)} if kind == "collect" else {"do": kind}), size


def _job(rng: random.Random, config: Config, size: tuple[int, int], tag: int) -> Job:
    """A job: mostly inside an image of `size`, at its edges more often than not; some a step outside, some anything."""
    slots = [rng.randrange(rng.choice((3, config.slots))) for _ in range(2)]
    if rng.random() < 0.2:
        low, most = config.min_window, config.max_window
        window = [rng.choice((low, rng.choice((0, 1, low - 1, most, most + 1, 255, rng.randrange(256)))))
                  for _ in range(2)]
        where = [rng.choice((0, 3, rng.randint(0, COORDINATE_MAX), COORDINATE_MAX)) for _ in range(4)]
        offsets = [rng.choice((0, 1, 5, 5, COORDINATE_MAX)) for _ in range(2)]
        return Job(rng.randrange(8), where[0], where[1], window[0], window[1], rng.randrange(8), where[2], where[3],
                   offsets[0], offsets[1], tag)
    w, h = (min(extreme(rng, config.min_window, config.max_window), s) for s in size)
    across, down = extreme(rng, 1, size[0] - w + 1), extreme(rng, 1, size[1] - h + 1)
    if across * down * h > MOST_WORK[config.name]:
        down = max(1, MOST_WORK[config.name] // (across * h))
    over = [rng.choice((1, 1, 2, 50)) if rng.random() < 0.03 else 0 for _ in range(4)]
    where = [extreme(rng, 0, size[0] - w), extreme(rng, 0, size[1] - h), extreme(rng, 0, size[0] - w - across + 1),
             extreme(rng, 0, size[1] - h - down + 1)]
    where = [min(limit + more if more else at, COORDINATE_MAX) for at, more, limit in zip(
        where, over, (size[0] - w, size[1] - h, size[0] - w - across + 1, size[1] - h - down + 1), strict=True)]
    return Job(slots[0], where[0], where[1], w, h, slots[1], where[2], where[3], across, down, tag)


def _answer(board: Board, operation: Operation) -> tuple[str, Any]:
    """What the board answers, in a form that can be compared and shown."""
    try:
        return "answer", _DO[operation["do"]](board, operation)
    except BoardError as error:
        return "refused", str(error)


def _capture(board: Board, o: Operation) -> None:
    frames = [texture(board.image_size, s) for s in o["seeds"]]
    if len(frames) == 1:
        board.capture(o["slots"][0], frames[0], o["camera"])
    else:
        board.capture_pair((o["slots"][0], o["slots"][1]), (frames[0], frames[1]))


def _surface(board: Board, o: Operation) -> Any:
    result, surface = board.surface(Job(**o["job"]))
    return result, surface.tobytes()


def _finish(board: Board, o: Operation) -> Any:
    """Everything that is left: results, planes, counters."""
    results = board.collect(board.outstanding)
    planes = [_answer(board, {"do": "plane", "slot": slot}) for slot in range(board.config.slots)]
    return results, planes, _counters(board)


def _counters(board: Board, o: Operation | None = None) -> dict[str, int]:
    return {name: count for name, count in board.counters().items() if name not in NOT_COMPARED}


def _counters_at_rest(board: Board, o: Operation) -> Any:
    return board.collect(board.outstanding), _counters(board)


_DO: dict[str, Callable[[Board, Operation], Any]] = {
    "configure": lambda board, o: board.configure((o["size"][0], o["size"][1]), o["sigma"]),
    "capture": _capture,
    "plane": lambda board, o: np.packbits(board.read_plane(o["slot"])).tobytes(),
    "submit": lambda board, o: board.submit([Job(**job) for job in o["jobs"]]),
    "grid": lambda board, o: board.submit_grid(Job(**o["job"]), tuple(o["count"]), tuple(o["step"])),
    "collect": lambda board, o: board.collect(min(o["count"], board.outstanding)),
    "surface": _surface,
    "counters": _counters_at_rest,
    "finish": _finish,
}


def _count(met: Counter[str], config: Config, board: Board, operation: Operation, answer: tuple[str, Any]) -> None:
    """Count what an operation met, for the functional coverage."""
    kind, value = answer
    met[f"{operation['do']} {kind}"] += 1
    g = config.group_bits
    if operation["do"] == "configure" and kind == "answer":
        met[f"image width {operation['size'][0] % g} beyond a word"] += 1
    if operation["do"] in ("collect", "finish", "counters") and kind == "answer":
        for result in value if operation["do"] == "collect" else value[0]:
            met[f"result {Status(result.status).name}"] += 1
    if operation["do"] == "submit" and kind == "answer":
        for job in operation["jobs"]:
            met[f"window width {job['width'] % g} beyond a word"] += 1
            met["window height odd" if job["height"] % 2 else "window height even"] += 1
            met[f"search position {job['search_x'] % g} beyond a word"] += 1
            met[f"template position {job['tpl_x'] % g} beyond a word"] += 1
            met[f"offsets {job['offsets_x'] % (g // 2)} beyond a pitch"] += 1
            met["coordinate 1023"] += COORDINATE_MAX in job.values()
