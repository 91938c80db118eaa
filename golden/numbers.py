# SPDX-License-Identifier: Apache-2.0
"""Whole numbers that a register takes, whatever integer type a caller has them in."""

from __future__ import annotations

import operator


def whole(name: str, value: object, low: int, top: int) -> int:
    """`value` as a Python integer.

    Raises:
        ValueError: if it is not a whole number or lies outside `low`..`top`; the text begins with `name`.
    """
    try:
        number = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise ValueError(f"{name} is {value!r}: must be a whole number") from None
    if not low <= number <= top:
        raise ValueError(f"{name} is {number}: must lie in {low}..{top}")
    return number
