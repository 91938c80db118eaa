# SPDX-License-Identifier: Apache-2.0
"""Makes a case that shows a difference as short as it gets, within a time."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from tests.soak.case import Case, Operation

LISTS = "jobs", "pieces", "cameras"
"""Arguments of operations from which elements may be left out; one element stays."""


def shrink(case: Case, differs: Callable[[Case], bool], seconds: float = 120.0) -> Case:
    """The shortest case found: with fewer operations, fewer elements in them, and registers at 0 at power-up.

    Args:
        case: shows the difference.
        differs: whether a case shows the same difference.
        seconds: after which the best so far is returned.
    """
    end = time.monotonic() + seconds

    def better(candidate: Case) -> bool:
        return time.monotonic() < end and differs(candidate)

    case = replace(case, operations=_fewer(case.operations, lambda some: better(replace(case, operations=some))))
    if case.power_up and better(replace(case, power_up=0)):
        case = replace(case, power_up=0)
    for number in range(len(case.operations)):
        for key in LISTS:
            case = _shorter(case, number, key, better)
    return case


def _fewer(whole: tuple[Any, ...], differs: Callable[[tuple[Any, ...]], bool]) -> tuple[Any, ...]:
    """Leave out halves, quarters, ... single elements as long as the rest still differs; the last stays."""
    size = len(whole)
    while size:
        for start in reversed(range(0, len(whole), size)):
            rest = whole[:start] + whole[start + size:]
            if rest and differs(rest):
                whole = rest
        size //= 2
    return whole


def _shorter(case: Case, number: int, key: str, differs: Callable[[Case], bool]) -> Case:
    """Leave out elements of one argument of one operation."""
    if key not in case.operations[number]:
        return case

    def with_list(some: tuple[Any, ...]) -> Case:
        changed: Operation = {**case.operations[number], key: list(some)}
        return replace(case, operations=(*case.operations[:number], changed, *case.operations[number + 1:]))

    return with_list(_fewer(tuple(case.operations[number][key]), lambda some: differs(with_list(some))))


def words(case: Case) -> Iterator[str]:
    """A case in a few lines: an operation a line."""
    yield f"{case.part} on {case.config}, power-up {case.power_up}"
    for operation in case.operations:
        text = ", ".join(f"{key} {value}" for key, value in operation.items() if key != "do")
        yield f"  {operation['do']}: {text}"[:160]
