# SPDX-License-Identifier: Apache-2.0
"""`slog_control` against its cycle model on every clock."""

import random
from collections.abc import Callable

import cocotb

from cocotb_tests.env.axil import AxilMaster
from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.diagram import check_diagram
from golden.cycle.control.control import ControlModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import CONFIGS
from golden.traffic.lasting import lasting
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.registers.map import fields
from sim.testbench.runner import AXI_PORTS, simulate

CLOCKS = 6000


def traffic(rng: random.Random, config: str, master: AxilMaster, enough: Callable[[], bool]) -> Stimulus:
    """Random accesses to the whole map, every input busy, for as long as it takes; the store answers peeks after random
    times."""
    c = CONFIGS[config]
    addresses = sorted({f.address for f in fields().values()} | {0x1C, 0x38, 0x88, 0xFC})
    commands = [f.address for name, f in fields().items() if name.endswith(".go") or name == "image_size.width"]
    peek: list[int] = []
    held: Inputs = {}
    for t in lasting(CLOCKS, 10 * CLOCKS, enough):
        if t % 701 == 0:
            master.write(fields()["irq_enable.drop"].address, rng.randrange(1, 16))
        if len(master.waiting) < 4:
            address = rng.choice(addresses)
            if rng.random() < 0.4:
                address = rng.choice(commands)
            if rng.random() < 0.6:
                data = rng.getrandbits(32) | -(rng.random() < 0.5) & 1 << 31
                if address == fields()["image_size.width"].address:
                    data = rng.randrange(c.min_image - 2, c.max_width + 2) | rng.randrange(
                        c.min_image - 2, c.max_height + 2) << 16
                if address == fields()["peek_address.word"].address and rng.random() < 0.8:
                    data = 1 << 31 | rng.randrange(c.store_words)
                master.write(address, data, 0xF if rng.random() < 0.8 else rng.getrandbits(4))
                if address == fields()["peek_address.word"].address:
                    # Once more at once: the address changes while its read is on its way.
                    for _ in range(rng.randrange(3)):
                        master.write(address, 1 << 31 | rng.randrange(c.store_words))
                    master.read(fields()["peek_data.value"].address)
                if address == fields()["image_size.width"].address:
                    master.write(fields()["filter.go"].address, fields()["filter.go"].mask)
            else:
                master.read(address)
        if t % 8 == 0:
            held = {"active_i": rng.getrandbits(2) & -(rng.random() < 0.15), "job_level_i": rng.randrange(9),
                    "writing_i": rng.getrandbits(2) & -(rng.random() < 0.1), "slot_valid_i": rng.getrandbits(8),
                    "armed_i": rng.getrandbits(2), "refused_i": rng.getrandbits(1), "job_busy_i": rng.getrandbits(1),
                    "result_level_i": rng.randrange(5), "work_i": rng.getrandbits(1),
                    "result_valid_i": rng.getrandbits(1),
                    "result_i": rng.getrandbits(189) & ~(-(rng.random() < 0.5) & 7 << 170)}
        done = bool(peek) and peek[0] == 0
        peek = [n - 1 for n in peek if n]
        ready = int(not peek and not done and rng.random() < 0.5)
        out = yield {
            **master.drive(), **held, "rst_i": int(t % 701 == 700), "accepted_i": rng.getrandbits(2),
            "dropped_i": rng.getrandbits(2) & -(rng.random() < 0.1), "captured_i": int(rng.random() < 0.05),
            "job_ready_i": int(rng.random() < 0.8),
            "score_i": rng.getrandbits(1), "peek_ready_i": ready, "peek_done_i": int(done),
            "peek_data_i": rng.getrandbits(c.group_bits), "s_axil_awprot": 0, "s_axil_arprot": 0,
            "ext_rd_data_i": rng.getrandbits(32) & -(rng.random() < 0.5), "ext_irq_i": int(rng.random() < 0.1)}
        if ready and out["peek_valid_o"]:
            peek = [rng.randrange(6)]
        if t % 701 == 700:
            peek = []
            master.reset()
        else:
            master.observe(out)


@cocotb.test()
async def resets_while_loading(dut) -> None:
    """A reset in any clock of the loading of zeros that follows a reset: all of it begins anew."""
    config = CONFIGS["tiny"]
    held = 0

    def stimulus() -> Stimulus:
        nonlocal held
        for clocks in (*range(4 * config.coefs + 8), 100):
            for _ in range(clocks):
                out = yield {}
                held += bool(out["hold_o"])
            yield {"rst_i": 1}

    await check_cycles(dut, ControlModel(config, fields()), stimulus())
    assert held > 500


@cocotb.test()
@cocotb.parametrize(shape=SHAPES, overlap=[1, 8])
async def every_clock(dut, shape: str, overlap: int) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    config = CONFIGS["tiny"]
    master = AxilMaster(ready_pattern(shape, rng), overlap)
    seen = dict.fromkeys(("s_axil_bvalid", "s_axil_rvalid", "job_valid_o", "capture_valid_o", "result_ready_o", "irq_o",
                          "hold_o", "slots_clear_o", "peek_valid_o"), 0)

    def count(_: Inputs, out: Outputs) -> None:
        for name in seen:
            seen[name] += bool(out[name])

    def enough() -> bool:
        return master.finished > 120 and all(seen.values())

    model = ControlModel(config, fields(), extension=True)
    await check_cycles(dut, model, traffic(rng, config.name, master, enough), count)
    assert master.finished > 120
    assert all(seen.values()), [name for name, times in seen.items() if not times]


@cocotb.test()
async def timing_diagram(dut) -> None:
    await check_diagram(dut, "control", ControlModel(CONFIGS["tiny"], fields()))


@cocotb.test()
async def size_written_as_it_is_applied(dut) -> None:
    """A size out of range is written in any clock around that in which the size before it is applied."""
    config = CONFIGS["tiny"]
    rng = random.Random(cocotb.RANDOM_SEED)
    master = AxilMaster(ready_pattern("none", rng))
    size, go = fields()["image_size.width"].address, fields()["filter.go"]
    errors: set[int | None] = set()

    def stimulus() -> Stimulus:
        for wait in range(26):
            master.write(size, config.min_image + wait % 2 | config.min_image << 16)
            master.write(go.address, go.mask)
            for t in range(120):
                if t == 14 + wait:
                    master.write(size, config.min_image - 1 | config.min_image << 16)
                if t == 100:
                    status = master.read(fields()["filter.size_error"].address)
                out = yield dict(master.drive())
                master.observe(out)
            errors.add(fields()["filter.size_error"].unpack(status.data or 0))

    await check_cycles(dut, ControlModel(config, fields()), stimulus())
    assert errors == {0, 1}


def test_control() -> None:
    simulate("tb_control", __name__, ports=AXI_PORTS)
