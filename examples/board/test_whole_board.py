# SPDX-License-Identifier: Apache-2.0
"""The whole board (`tiny`) in a cocotb test of one's own: registers over AXI4-Lite, two frames of video, one job."""

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge
from cocotbext.axi import AxiLiteBus, AxiLiteMaster

from golden.log import kernels
from golden.params import TINY
from sim.registers.map import address, fields, word

WIDTH, HEIGHT = 48, 36


async def send(dut, image) -> None:
    """A frame into camera 0, whose bits are the low ones of the ports."""
    for index, pixel in enumerate(image.reshape(-1)):
        dut.vid_tvalid_i.value, dut.vid_tdata_i.value = 1, int(pixel)
        dut.vid_tuser_i.value, dut.vid_tlast_i.value = int(index == 0), int(index % WIDTH == WIDTH - 1)
        await RisingEdge(dut.clk_i)
        while not int(dut.vid_tready_o.value) & 1:
            await RisingEdge(dut.clk_i)
    dut.vid_tvalid_i.value = 0


@cocotb.test()
async def finds_the_motion(dut) -> None:
    """The second frame shows the first one moved by (3, 2) pixels."""
    Clock(dut.clk_i, 10, unit="ns").start()
    for name in ("vid_tdata_i", "vid_tvalid_i", "vid_tuser_i", "vid_tlast_i", "surf_tready_i"):
        getattr(dut, name).value = 0
    dut.rst_i.value = 1
    bus = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk_i, dut.rst_i)
    await ClockCycles(dut.clk_i, 4)
    dut.rst_i.value = 0
    async def write(register: str, **values: int) -> None:
        await bus.write_dword(address(register), word(register, **values))
    async def read(field: str) -> int:
        return fields()[field].unpack(await bus.read_dword(fields()[field].address))
    for (second, index), value in np.ndenumerate(kernels(2.0, TINY.radius)):
        await write("coef", value=int(value), second=second, index=index, go=1)
    await write("image_size", width=WIDTH, height=HEIGHT)
    await write("filter", go=1)
    scene = np.random.default_rng(1).integers(0, 256, (60, 60), np.uint8)
    for slot, (x, y) in enumerate(((8, 8), (5, 6))):
        await write("capture", camera=0, slot=slot, go=1)
        await send(dut, scene[y:y + HEIGHT, x:x + WIDTH])
        while await read("slot_status.armed"):
            pass
    await write("job.tpl", slot=0, x=16, y=10)
    await write("job.window", width=12, height=12)
    await write("job.search", slot=1, x=10, y=5)
    await write("job.offsets", across=13, down=11)
    await write("job.submit", tag=7, go=1)
    while not await read("result.head.valid"):
        pass
    assert (await read("result.best.x") + 10 - 16, await read("result.best.y") + 5 - 10) == (3, 2)
