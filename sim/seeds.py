# SPDX-License-Identifier: Apache-2.0
"""The seed of a run: cocotb tests and the lockstep tests of both boards draw from it. Statistical bars keep seeds of
their own."""

from __future__ import annotations

import os
import random

VARIABLE = "SIGNUM_SEED"


def session_seed() -> int:
    """The run's seed, from the environment variable `SIGNUM_SEED`; 1 if it is not set.

    Raises:
        SystemExit: if it is not a whole number of 0 to 2**31 - 1.
    """
    text = os.environ.get(VARIABLE) or "1"
    if not (text.isascii() and text.isdigit() and int(text) < 1 << 31):
        raise SystemExit(f"{VARIABLE}={text}: give a whole number, 0 to {(1 << 31) - 1}")
    return int(text)


def session_rng(what: str) -> random.Random:
    """Random numbers of the run's seed for one purpose; `what` keeps purposes apart."""
    return random.Random(f"{session_seed()} {what}")
