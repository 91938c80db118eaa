# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_control` against its cycle model on every clock, and its map against its source."""

import random

import cocotb
from systemrdl.compiler import RDLCompiler
from systemrdl.node import FieldNode, RegNode

from cocotb_tests.env.check import check_cycles
from golden.cycle.control.dense_control import UNKNOWN, DenseControlModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import DENSE
from golden.traffic.lasting import lasting
from sim.registers.map import Field, dense_fields, fields
from sim.testbench.runner import simulate
from sim.toolchain import RTL

CLOCKS = 6000
RESETS = 809
"""Clocks from one reset to the next."""


def traffic(rng: random.Random, seen: dict[str, int]) -> Stimulus:
    """Requests to every address as `slog_axil` makes them, and an engine that is busy now and then."""
    places = sorted({f.address for f in dense_fields().values()} | {0x00, 0xCC, 0xF8, 0xFC})
    run = dense_fields()["dense.run.go"].address
    idle = dict.fromkeys(DenseControlModel.INPUTS, 0)
    request: Inputs = {}
    age = pause = busy = begin = 0
    for t in lasting(CLOCKS, 10 * CLOCKS, lambda: min(seen.values()) >= 3):
        begins = age == 4 and request["is_wr_i"] and request["addr_i"] == run
        rst = int(t % RESETS == RESETS - 1 or (begins and rng.random() < 0.05))
        if age >= pause:
            write = rng.random() < 0.6
            request = {"is_wr_i": int(write), "addr_i": run if rng.random() < 0.4 else rng.choice(places),
                       "data_i": rng.getrandbits(32) | (rng.random() < 0.7) << 31,
                       "biten_i": sum(0xFF << 8 * byte for byte in range(4) if rng.random() < 0.9)}
            age, pause = 0, rng.choice((5, 6, 9, 20))
        held = {name: request[name] for name in ("is_wr_i", "addr_i")} if age < 6 else {
            "is_wr_i": rng.getrandbits(1), "addr_i": rng.getrandbits(8)}
        late = age in (2, 3)
        noise = {"data_i": rng.getrandbits(32), "biten_i": rng.choice((0, 0xFFFFFFFF))}
        done = int(busy == 1)
        out = yield {**idle, **(dict(request) if late else {**noise, **held}), **held, "rst_i": rst,
                     "req_i": int(age == 0 and not rst), "busy_i": int(busy > 0), "done_i": done,
                     "status_i": rng.randrange(7), "row_i": rng.getrandbits(1), "stall_i": rng.getrandbits(1)}
        age = pause if rst else age + 1
        busy = max(busy - 1, 0)
        if begin:
            begin -= 1
            busy = 0 if begin else rng.choice((1, 3, 60))
        elif out["start_o"]:
            begin = rng.randint(1, 3)
        if rst:
            busy = begin = 0
        for name, value in (("starts", out["start_o"]), ("cancels", out["cancel_o"]), ("interrupts", out["irq_o"]),
                            ("values", out["rd_data_o"])):
            seen[name] += bool(value)


@cocotb.test()
async def every_clock(dut) -> None:
    seen = dict.fromkeys(("starts", "cancels", "interrupts", "values"), 0)
    rng = random.Random(cocotb.RANDOM_SEED)
    await check_cycles(dut, DenseControlModel(DENSE, dense_fields()), traffic(rng, seen), reset_clocks=UNKNOWN)
    assert min(seen.values()) >= 3, seen


@cocotb.test()
async def each_cause_alone(dut) -> None:
    """A start while a pass is under way is lost, and counted by its interrupt alone; the end of a pass by the other."""
    place = dense_fields()
    enable, cleared = place["dense.irq_enable.done"].address, place["dense.irq_status.done"].address
    script = [(enable, 1, 0, "done"), (enable, 2, 0, "done"), (enable, 1, 1, "lost"), (enable, 2, 1, "lost")]
    seen: list[int] = []

    def access(address: int, data: int, **more: int) -> Stimulus:
        for age in range(10):
            yield {"req_i": int(age == 0), "is_wr_i": 1, "addr_i": address, "data_i": data, "biten_i": 0xFFFFFFFF,
                   **more}

    def stimulus() -> Stimulus:
        for address, data, busy, _ in script:
            yield from access(address, data)
            yield from access(place["dense.run.go"].address, 1 << 31, busy_i=busy)
            yield {"done_i": 1 - busy}
            for _ in range(4):
                out: Outputs = yield {}
            seen.append(out["irq_o"])
            yield from access(cleared, 3)
            out = yield {}
            assert not out["irq_o"]

    await check_cycles(dut, DenseControlModel(DENSE, place), stimulus(), reset_clocks=UNKNOWN)
    assert seen == [1, 0, 0, 1]


def test_dense_control() -> None:
    c = DENSE
    simulate("slog_dense_control", __name__, {"Offsets": c.dense_offsets, "Lanes": c.dense_lanes,
                                              "MaxWindow": c.dense_window, "Sizes": c.dense_sizes})


def test_the_map_is_the_source_and_leaves_the_board_s_alone() -> None:
    compiler = RDLCompiler()
    compiler.compile_file(str(RTL / "control" / "slog_dense_csr.rdl"))
    found: dict[str, Field] = {}
    for node in compiler.elaborate().top.descendants(unroll=True):
        if isinstance(node, FieldNode):
            assert isinstance(node.parent, RegNode)
            found[node.get_path().partition(".")[2]] = Field(node.parent.absolute_address, node.low, node.width)
    assert found == dense_fields() and len(found) >= 25
    assert {f.address for f in found.values()}.isdisjoint(f.address for f in fields().values())
    assert all(name.startswith("dense.") for name in found) and not any(name.startswith("dense.") for name in fields())
