# SPDX-License-Identifier: Apache-2.0
"""How long a random run lasts: its length is given, what it meets depends on the seed."""

from __future__ import annotations

from collections.abc import Callable, Iterator


def lasting(least: int, most: int, enough: Callable[[], bool]) -> Iterator[int]:
    """Numbers of clocks from 0: `least` of them, then on until `enough()`, but no more than `most`."""
    for t in range(most):
        if t >= least and enough():
            return
        yield t
