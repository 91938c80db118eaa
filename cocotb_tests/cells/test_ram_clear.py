# SPDX-License-Identifier: Apache-2.0
"""`slog_ram_clear` and its ECP5 twin against one cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.cells.ram_clear import RamClearModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from sim.testbench.runner import simulate

CLOCKS = 1500
SMALL = 64


def _accesses(rng: random.Random, width: int, depth: int) -> Stimulus:
    """Random writes, reads and clears at all addresses of a small memory, at a few of a large one, the first and
    the last among them; never a write to the address that is read."""
    few = {0, depth - 1, depth // 2, *(rng.randrange(depth) for _ in range(12))}
    addresses = sorted(few) if depth > SMALL else range(depth)
    for _ in range(CLOCKS):
        to, at = rng.choice(addresses), rng.choice(addresses)
        yield {"wr_en_i": int(to != at and rng.random() < 0.6), "wr_addr_i": to, "wr_data_i": rng.getrandbits(width),
               "rd_addr_i": at, "clear_i": int(rng.random() < 0.2)}


@cocotb.test()
async def every_clock(dut) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    reads = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal reads
        reads += bool(out["rd_data_o"])

    await check_cycles(dut, RamClearModel(), _accesses(rng, params()["Width"], params()["Depth"]), count,
                       reset_clocks=0)
    assert reads > CLOCKS // 4


@pytest.mark.parametrize("ecp5", [False, True])
@pytest.mark.parametrize(("width", "depth"), [(44, 48), (40, 512), (20, 656), (11, 2000)])
def test_ram_clear(width: int, depth: int, ecp5: bool) -> None:
    simulate("slog_ram_clear", __name__, {"Width": width, "Depth": depth}, ecp5=ecp5)
