# SPDX-License-Identifier: Apache-2.0
"""Every field of the generated registers over AXI4-Lite."""

import random
from itertools import product
from typing import Any, cast

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer
from cocotbext.axi import AxiLiteBus, AxiLiteMaster
from systemrdl.compiler import RDLCompiler
from systemrdl.node import AddressableNode, FieldNode, RegNode

from golden.cycle.control.control import ControlModel
from golden.params import CONFIGS
from sim.registers.map import Field, address, fields, word
from sim.testbench.runner import AXI_PORTS, simulate
from sim.toolchain import RTL

MANY = 1 << 14
"""Events in consecutive clocks."""
PLACES = 32
"""Coefficients that can be written; those that the filter does not have change nothing."""


def rdl_fields() -> dict[str, FieldNode]:
    """Fields by path from the source itself, arrays unrolled: not by way of the generated access layer."""
    compiler = RDLCompiler()
    compiler.compile_file(str(RTL / "control" / "slog_csr.rdl"))
    top = compiler.elaborate().top
    found: dict[str, FieldNode] = {}

    def walk(node: AddressableNode) -> None:
        for child in node.children(unroll=True):
            if isinstance(child, FieldNode):
                found[child.get_path().partition(".")[2]] = child
            elif isinstance(child, AddressableNode):
                walk(child)

    walk(top)
    return found


async def start(dut: Any) -> AxiLiteMaster:
    """Clock, reset, idle inputs."""
    Clock(dut.clk_i, 10, unit="ns").start()
    for name in ControlModel.INPUTS:
        if not name.startswith("s_axil") and name != "rst_i":
            getattr(dut, name).value = 0
    dut.rst_i.value = 1
    master = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk_i, dut.rst_i)
    for _ in range(4):
        await RisingEdge(dut.clk_i)
    dut.rst_i.value = 0
    await RisingEdge(dut.clk_i)
    return master


@cocotb.test()
async def map_is_the_source(dut) -> None:
    """The generated access layer names every field of the source, at its place."""
    await start(dut)
    source = {path: Field(node.parent.absolute_address, node.low, node.width) for path, node in rdl_fields().items()}
    assert source == fields() and len(source) > 80
    for node in rdl_fields().values():
        assert isinstance(node.parent, RegNode)


@cocotb.test()
async def stored_fields(dut) -> None:
    """Reset value, every bit both ways, no other field disturbed, byte strobes."""
    bus = await start(dut)
    rng = random.Random(cocotb.RANDOM_SEED)
    nodes = rdl_fields()
    stored = {p: f for p, f in fields().items()
              if nodes[p].is_sw_writable and nodes[p].is_sw_readable and not nodes[p].get_property("woclr")}
    assert len(stored) >= 29
    held: dict[str, int] = {p: cast(int, nodes[p].get_property("reset") or 0) for p in stored}
    for path, field in stored.items():
        assert field.unpack(await bus.read_dword(field.address)) == held[path], f"{path} after reset"
    for path, field in stored.items():
        top = (1 << field.width) - 1
        for value in (top, 0, rng.getrandbits(field.width), 0x55555555 & top, 0x2AAAAAAA & top):
            register = [p for p, f in stored.items() if f.address == field.address]
            held[path] = value
            await bus.write_dword(field.address, sum(stored[p].pack(held[p]) for p in register))
            read = await bus.read_dword(field.address)
            assert read == sum(stored[p].pack(held[p]) for p in register), f"{path} written with {value:#x}"
    for path, field in stored.items():
        assert field.unpack(await bus.read_dword(field.address)) == held[path], f"{path} changed by another write"
    for byte in range(4):
        await bus.write_dword(address("image_size"), 0)
        await bus.write(address("image_size") + byte, b"\xff")
        mask = sum(f.mask for p, f in fields().items() if p.startswith("image_size."))
        assert await bus.read_dword(address("image_size")) == mask & 0xFF << 8 * byte


@cocotb.test()
async def status_fields(dut) -> None:
    """Everything hardware drives shows in its field and nowhere else; writing to it changes nothing."""
    bus = await start(dut)
    config = CONFIGS["tiny"]
    rng = random.Random(cocotb.RANDOM_SEED)
    model = ControlModel(config, fields())
    driven = {name: rng.getrandbits(len(getattr(dut, name))) for name in (
        "active_i", "slot_valid_i", "armed_i", "writing_i", "refused_i", "job_ready_i", "job_level_i", "job_busy_i",
        "result_valid_i", "result_i", "result_level_i")}
    nodes = rdl_fields()
    checked = 0
    for _ in range(2):  # every bit is seen at 0 and at 1
        for name, value in driven.items():
            driven[name] = value ^ (1 << len(getattr(dut, name))) - 1
            getattr(dut, name).value = driven[name]
        await RisingEdge(dut.clk_i)
        model.seen = driven["result_valid_i"]
        want = model.status(driven, driven["result_i"])
        for path, status in want.items():
            if path.startswith("counter.") or path == "filter.busy":
                continue
            for _ in range(2):
                read = fields()[path].unpack(await bus.read_dword(fields()[path].address))
                assert read == status, f"{path} is {read:#x}, should be {status:#x}"
                if not nodes[path].parent.has_sw_writable:
                    await bus.write_dword(fields()[path].address, 0xFFFFFFFF)
            checked += 1
    assert checked >= 80


@cocotb.test()
async def commands_pulse_once(dut) -> None:
    """Each command reaches its output exactly one clock long; go reads as 0."""
    bus = await start(dut)
    seen = dict.fromkeys(("capture_valid_o", "job_valid_o", "result_ready_o"), 0)

    async def watch() -> None:
        while True:
            await FallingEdge(dut.clk_i)
            for name in seen:
                seen[name] += int(getattr(dut, name).value)

    task = cocotb.start_soon(watch())
    for register, name in (("capture", "capture_valid_o"), ("job.submit", "job_valid_o"),
                           ("result.pop", "result_ready_o")):
        for n in range(1, 4):
            await bus.write_dword(address(register), word(register, go=1))
            assert not fields()[f"{register}.go"].unpack(await bus.read_dword(address(register)))
            assert seen[name] == n
    await bus.write_dword(address("job.submit"), word("job.submit", tag=5))
    await bus.read_dword(address("id"))
    assert seen["job_valid_o"] == 3
    task.cancel()


@cocotb.test()
async def counters_and_interrupt(dut) -> None:
    """Each counter counts its event alone; each cause raises the interrupt when enabled, and clears as stated."""
    bus = await start(dut)
    causes = {"scores": ("score_i", 1), "busy": ("work_i", 1), "frames[0]": ("accepted_i", 1),
              "frames[1]": ("accepted_i", 2), "drops[0]": ("dropped_i", 1), "drops[1]": ("dropped_i", 2)}
    for n, (port, value) in enumerate(causes.values()):
        getattr(dut, port).value = value
        for _ in range(n + 3):
            await RisingEdge(dut.clk_i)
        getattr(dut, port).value = 0
    for n, name in enumerate(causes):
        assert await bus.read_dword(address(f"counter.{name}")) == n + 3, name
    for port, value in (("score_i", 1), ("work_i", 1), ("accepted_i", 3), ("dropped_i", 3)):
        getattr(dut, port).value = value
    await Timer(MANY * 10 + 5, unit="ns")
    for port in ("score_i", "work_i", "accepted_i", "dropped_i"):
        getattr(dut, port).value = 0
    for n, name in enumerate(causes):
        assert await bus.read_dword(address(f"counter.{name}")) == MANY + n + 3, name
    first = await bus.read_dword(address("counter.clocks"))
    for _ in range(50):
        await RisingEdge(dut.clk_i)
    assert await bus.read_dword(address("counter.clocks")) - first == 50 + 14  # the read itself

    assert await bus.read_dword(address("irq_status")) == fields()["irq_status.drop"].mask
    await bus.write_dword(address("irq_status"), 0xFFFFFFFF)
    assert await bus.read_dword(address("irq_status")) == 0
    ports = {"capture": "captured_i", "drop": "dropped_i", "result": "result_valid_i"}
    for cause in ("result", "capture", "drop", "overflow"):
        for enabled in (0, 1):
            await bus.write_dword(address("irq_enable"), word("irq_enable", **{cause: enabled}))
            if cause == "overflow":  # job_ready_i is low
                await bus.write_dword(address("job.submit"), word("job.submit", go=1))
            else:
                getattr(dut, ports[cause]).value = 1
                await RisingEdge(dut.clk_i)
            if cause != "result" and cause != "overflow":
                getattr(dut, ports[cause]).value = 0
            for _ in range(4):
                await RisingEdge(dut.clk_i)
            assert int(dut.irq_o.value) == enabled, cause
            assert await bus.read_dword(address("irq_status")) == word("irq_status", **{cause: 1})
            if cause == "result":
                dut.result_valid_i.value = 0
            else:
                await bus.write_dword(address("irq_status"), word("irq_status", **{cause: 1}))
            for _ in range(4):
                await RisingEdge(dut.clk_i)
            assert int(dut.irq_o.value) == 0 and await bus.read_dword(address("irq_status")) == 0, cause
    assert await bus.read_dword(address("counter.overflows")) == 2


@cocotb.test()
async def filter_and_peek(dut) -> None:
    """Coefficients change on commit and only when the cameras are idle; planes read back in order."""
    bus = await start(dut)
    config = CONFIGS["tiny"]
    rng = random.Random(cocotb.RANDOM_SEED)
    values = {second: [rng.getrandbits(18) for _ in range(config.coefs)] for second in (0, 1)}
    for second, index in product((0, 1), range(PLACES)):
        before = rng.getrandbits(18)
        for value in (before, before ^ (1 << 18) - 1, before):
            await bus.write_dword(address("coef"), word("coef", value=value, second=second, index=index, go=1))
    for second, kernel in values.items():
        for index, value in enumerate(kernel):
            await bus.write_dword(address("coef"), word("coef", value=value, second=second, index=index, go=1))
    await bus.write_dword(address("image_size"), word("image_size", width=40, height=30))
    dut.active_i.value = 1
    assert int(dut.g_o.value) == 0 and int(dut.hold_o.value) == 0
    await bus.write_dword(address("filter"), word("filter", go=1))
    assert await bus.read_dword(address("filter")) == word("filter", busy=1, active=1)
    assert int(dut.g_o.value) == 0 and int(dut.hold_o.value) == (1 << config.cameras) - 1
    dut.active_i.value = 0
    settled = 24 + 3 * config.coefs  # clocks: the coefficients are shifted in
    for _ in range(settled):
        await RisingEdge(dut.clk_i)
    for port, second in ((dut.g_o, 0), (dut.g2_o, 1)):
        assert int(port.value) == sum(v << 18 * k for k, v in enumerate(values[second]))
    assert await bus.read_dword(address("filter")) == 0
    assert await bus.read_dword(address("image_active")) == word("image_active", width=40, height=30)
    for width, height in ((config.min_image - 1, 30), (config.max_width + 1, 30), (40, config.max_height + 1)):
        await bus.write_dword(address("image_size"), word("image_size", width=width, height=height))
        await bus.write_dword(address("filter"), word("filter", go=1))
        for _ in range(settled):
            await RisingEdge(dut.clk_i)
        assert await bus.read_dword(address("filter")) == word("filter", size_error=1)
        assert await bus.read_dword(address("image_active")) == word("image_active", width=40, height=30)

    async def store() -> None:
        """Holds at each address its low byte inverted; slow."""
        while True:
            await FallingEdge(dut.clk_i)
            if int(dut.peek_valid_o.value):
                at = int(dut.peek_addr_o.value)
                dut.peek_ready_i.value = 1
                await RisingEdge(dut.clk_i)
                dut.peek_ready_i.value = 0
                for _ in range(rng.randrange(12)):
                    await RisingEdge(dut.clk_i)
                dut.peek_done_i.value, dut.peek_data_i.value = 1, ~at & 0xFF
                await RisingEdge(dut.clk_i)
                dut.peek_done_i.value = 0

    assert await bus.read_dword(address("peek_data")) == 0
    task = cocotb.start_soon(store())
    last = config.store_words - 3
    for begin in (7, last, 100):
        await bus.write_dword(address("peek_address"), word("peek_address", word=begin, go=1))
        for k in range(begin, begin + 6):
            want = ~k & 0xFF if k < config.store_words else 0
            assert await bus.read_dword(address("peek_data")) == want, f"word {k}"
    task.cancel()


def test_registers() -> None:
    simulate("tb_control", __name__, ports=AXI_PORTS)
