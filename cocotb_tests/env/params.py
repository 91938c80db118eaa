# SPDX-License-Identifier: Apache-2.0
"""The parameters of the module under test."""

from __future__ import annotations

import json
import os


def params() -> dict[str, int]:
    """Parameters given to `sim.testbench.runner.simulate`, by name."""
    values: dict[str, int] = json.loads(os.environ["SLOG_PARAMS"])
    return values
