# SPDX-License-Identifier: Apache-2.0
"""AXI4-Lite of `slog_control` with the five channels driven independently, against its cycle model on every clock.

Addresses come long before their data and the reverse; addresses are unaligned and unmapped, strobes are any; idle wires
carry garbage; responses stall; resets fall anywhere. What the traffic reaches is counted and asserted.
"""

import random
from collections import Counter, deque

import cocotb

from cocotb_tests.env.check import check_cycles
from golden.cycle.control.control import ControlModel
from golden.cycle.model import Inputs, Stimulus
from golden.params import CONFIGS, Config
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.coverage.record import met
from sim.registers.map import fields
from sim.testbench.runner import AXI_PORTS, simulate

CLOCKS = 8000
RESET_EVERY = 97
"""Clocks from reset to reset, where there are any: coprime to the length of every access."""

LEAST = {
    "aw": 200, "w": 200, "ar": 150, "b": 150, "r": 150, "address first": 5, "data first": 5, "long before its data": 3,
    "long before its address": 3, "unaligned write": 50, "write to no register": 15, "unaligned read": 30,
    "read of no register": 10, "read during a write": 80, "b stalled": 20, "r stalled": 20,
    "address waits as a write ends": 50, "all strobes": 50, "other strobes": 50,
}
"""What a run must have met at least so many times."""
LEAST_WITHOUT_RESETS = {"new address as its peek is taken": 4}
LEAST_WITH_RESETS = {"reset of a request": 5, "reset of a response": 2, "reset of a read of peek_data": 5}


class Channel:
    """One request channel: a queue of transfers, each offered after a wait of its own and held until it is taken."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.queue: deque[tuple[int, int]] = deque()
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self.queue.clear()
        self.held, self.wait = False, 0

    def offer(self) -> tuple[int, tuple[int, int]]:
        """Valid and payload of this clock; the payload is random while not valid."""
        if self.queue and not self.held:
            self.held, self.wait = self.wait <= 0, self.wait - 1
        if self.held:
            return 1, self.queue[0]
        return 0, (self.rng.getrandbits(32), self.rng.getrandbits(4))

    def take(self) -> None:
        """The transfer was accepted; the next one waits from none to many clocks."""
        self.queue.popleft()
        self.held, self.wait = False, self.rng.choice((0, 0, 0, 1, 2, 3, self.rng.randrange(60)))


def _surroundings(rng: random.Random) -> Inputs:
    """What the rest of the board shows the registers."""
    return {"active_i": rng.getrandbits(2) & -(rng.random() < 0.15), "job_level_i": rng.randrange(9),
            "writing_i": rng.getrandbits(2) & -(rng.random() < 0.1), "slot_valid_i": rng.getrandbits(8),
            "armed_i": rng.getrandbits(2), "refused_i": rng.getrandbits(1), "job_busy_i": rng.getrandbits(1),
            "result_level_i": rng.randrange(5), "work_i": rng.getrandbits(1), "result_i": rng.getrandbits(189)}


def _write(rng: random.Random, c: Config, commands: list[int]) -> tuple[int, tuple[int, int]]:
    """Address, and data with strobes, of a write: mostly commands, some unaligned, some to no register."""
    at = rng.choice(commands) if rng.random() < 0.6 else rng.getrandbits(8)
    data = rng.getrandbits(32) | -(rng.random() < 0.5) & 1 << 31
    if at == fields()["image_size.width"].address:
        data = rng.randrange(c.min_image - 2, c.max_width + 2) | rng.randrange(c.min_image - 2, c.max_height + 2) << 16
    if at == fields()["peek_address.word"].address:
        data = 1 << 31 | rng.randrange(c.store_words + 2)
    if rng.random() < 0.3:
        at |= rng.getrandbits(2)
    return at, (data, 15 if rng.random() < 0.6 else rng.getrandbits(4))


def _traffic(rng: random.Random, model: ControlModel, seen: Counter[str], ahead: int, resets: bool) -> Stimulus:
    """Transfers of each channel, at most `ahead` of them waiting; `seen` counts what happens."""
    c = model.config
    commands = [f.address for name, f in fields().items() if name.endswith(".go") or name == "image_size.width"]
    mapped = {f.address for f in fields().values()}
    peek_address, peek_data = fields()["peek_address.word"].address, fields()["peek_data.value"].address
    aw, w, ar = (Channel(rng) for _ in range(3))
    channels = {"aw": aw, "w": w, "ar": ar}
    ready = {n: ready_pattern("none", rng) for n in ("b", "r")}
    peek: list[int] = []  # clocks until the store answers
    held: Inputs = {}
    taken = Counter[str]()  # addresses and data accepted since the reset, which pair up to writes
    last_taken = {"aw": -2, "w": -2, "ar": -2}
    for t in range(CLOCKS):
        if t % 400 == 0:
            ready = {n: ready_pattern(rng.choice(SHAPES[:3]), rng) for n in ready}
        if len(aw.queue) < ahead and len(w.queue) < ahead:
            address, payload = _write(rng, c, commands)
            for _ in range(1 + (address & 0xFC == peek_address and rng.random() < 0.7)):
                aw.queue.append((address, 0))
                w.queue.append(payload)
        if len(ar.queue) < ahead:
            ar.queue.append((rng.choice((peek_data, rng.getrandbits(8))), 0))
        if t % 8 == 0:
            held = _surroundings(rng)
        done = bool(peek) and peek[0] == 0
        peek = [n - 1 for n in peek if n]
        # The store takes a peek late, by preference in the clock in which the host changes the address; a reset meets a
        # read of peek_data that is just leaving for the register block.
        peek_ready = int(not peek and not done and rng.random() < (0.7 if model.peek.go else 0.07))
        request = model.csr.axil.request
        peeks = request is not None and not request.is_write and request.address == peek_data
        rst = int(resets and (t % RESET_EVERY == RESET_EVERY - 1 or (peeks and rng.random() < 0.2)))
        offers = {n: channel.offer() for n, channel in channels.items()}
        i = {"s_axil_awvalid": offers["aw"][0], "s_axil_awaddr": offers["aw"][1][0] & 0xFF,
             "s_axil_wvalid": offers["w"][0], "s_axil_wdata": offers["w"][1][0], "s_axil_wstrb": offers["w"][1][1],
             "s_axil_arvalid": offers["ar"][0], "s_axil_araddr": offers["ar"][1][0] & 0xFF,
             "s_axil_bready": next(ready["b"]), "s_axil_rready": next(ready["r"]),
             "s_axil_awprot": rng.getrandbits(3), "s_axil_arprot": rng.getrandbits(3), **held, "rst_i": rst,
             "accepted_i": rng.getrandbits(2), "dropped_i": rng.getrandbits(2) & -(rng.random() < 0.1),
             "captured_i": int(rng.random() < 0.05), "job_ready_i": int(rng.random() < 0.8),
             "result_valid_i": rng.getrandbits(1), "score_i": rng.getrandbits(1), "peek_ready_i": peek_ready,
             "peek_done_i": int(done), "peek_data_i": rng.getrandbits(c.group_bits)}
        seen["new address as its peek is taken"] += model.peek.go and model.peek.valid and bool(peek_ready)
        begun = model.csr.axil.begun is not None
        out = yield i
        if peek_ready and out["peek_valid_o"]:
            peek = [rng.randrange(6)]
        if rst:
            seen["reset of a request"] += request is not None or begun
            seen["reset of a read of peek_data"] += peeks
            seen["reset of a response"] += bool(out["s_axil_bvalid"] or out["s_axil_rvalid"])
            peek = []
            taken.clear()
            for channel in channels.values():
                channel.reset()
            continue
        moved = {n: bool(offers[n][0] and out[f"s_axil_{n}ready"]) for n in channels}
        for n in channels:
            if moved[n]:
                seen[n] += 1
                taken[n] += 1
                last_taken[n] = t
        if moved["aw"]:
            at = offers["aw"][1][0]
            seen["unaligned write"] += bool(at & 3)
            seen["write to no register"] += at & 0xFC not in mapped
            seen["long before its data"] += taken["aw"] > taken["w"] and w.wait > 20
        if moved["w"]:
            seen["all strobes" if offers["w"][1][1] == 15 else "other strobes"] += 1
            seen["address first"] += last_taken["aw"] < t and taken["aw"] >= taken["w"]
            seen["data first"] += taken["w"] > taken["aw"]
            seen["long before its address"] += taken["w"] > taken["aw"] and aw.wait > 20
        if moved["ar"]:
            at = offers["ar"][1][0]
            seen["unaligned read"] += bool(at & 3)
            seen["read of no register"] += at & 0xFC not in mapped
            seen["read during a write"] += taken["aw"] != taken["b"] or taken["w"] != taken["b"]
        for n in ("b", "r"):
            if out[f"s_axil_{n}valid"]:
                seen[f"{n} stalled"] += not i[f"s_axil_{n}ready"]
                answered = bool(i[f"s_axil_{n}ready"])
                seen[n] += answered
                taken[n] += answered
                seen["address waits as a write ends"] += answered and n == "b" and not out["s_axil_awready"]
        for n, channel in channels.items():
            if moved[n]:
                channel.take()
        assert taken["b"] <= min(taken["aw"], taken["w"]) and taken["r"] <= taken["ar"]


@cocotb.test()
@cocotb.parametrize(ahead=[1, 4], resets=[False, True])
async def independent_channels(dut, ahead: int, resets: bool) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    seen: Counter[str] = Counter()
    model = ControlModel(CONFIGS["tiny"], fields())
    await check_cycles(dut, model, _traffic(rng, model, seen, ahead, resets))
    dut._log.info(f"{dict(seen)}")
    met("register bus", seen)
    least = LEAST | (LEAST_WITH_RESETS if resets else LEAST_WITHOUT_RESETS)
    assert all(seen[what] >= count for what, count in least.items()), {w: seen[w] for w in least if seen[w] < least[w]}


def test_axi() -> None:
    simulate("tb_control", __name__, ports=AXI_PORTS)
