# SPDX-License-Identifier: Apache-2.0
"""Before a cocotb simulation begins: the clock is low and the reset asserted, whatever the power-up seed says.

Without this the first evaluation may see a rising edge of the clock and no reset, as both inputs are random at power-up
like everything else; assertions would then be evaluated on random registers before a test can drive anything.
"""

from __future__ import annotations

import cocotb
from cocotb.handle import Immediate

ENTRY_POINTS = ("cocotb_tools._coverage:start_cocotb_library_coverage", "cocotb.logging:_configure",
                "cocotb._init:init_package_from_simulation", f"{__name__}:hold_in_reset",
                "cocotb.regression:_run_regression")
"""What cocotb calls at the start of a simulation: its own four, and between them this module."""


def hold_in_reset() -> None:
    """Drive the clock and, if there is one, the reset."""
    for name, value in (("clk_i", 0), ("rst_i", 1)):
        if hasattr(cocotb.top, name):
            getattr(cocotb.top, name).set(Immediate(value))
