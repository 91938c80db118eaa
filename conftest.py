# SPDX-License-Identifier: Apache-2.0
"""Settings of every test: reproducible Hypothesis, no windows, unexpected errors raised, the simulation seed in the
heading."""

import os

import pytest
from hypothesis import settings

from sim.seeds import session_seed

os.environ.setdefault("MPLBACKEND", "Agg")
os.environ.setdefault("MAVLINK20", "1")  # receivers of the tests take MAVLink 2
os.environ["SIGNUM_RAISE"] = "1"  # an unexpected error of a command is an error of its test
settings.register_profile("signum", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("signum")


def pytest_report_header() -> str:
    """How to repeat a run."""
    return (f"signum: SIGNUM_SEED={session_seed()}, of cocotb and of both boards in lockstep; set it to repeat a run "
            "(WAVES=1 for waveforms)")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Slow tests first, so that no process waits for another's at the end."""
    items.sort(key=lambda item: item.get_closest_marker("slow") is None)
