# SPDX-License-Identifier: Apache-2.0
"""Abuse of the register bus: its five channels in their own time, unaligned and unmapped addresses, any strobes,
stalled responses. Each access is answered once, stored registers hold what was written, and the board works afterwards.
"""

from __future__ import annotations

import random
from collections import Counter

import numpy as np

from golden.correlate import Job, run
from golden.log import kernels, sign
from golden.params import Config
from sim.board.device import Device, DeviceError
from sim.board.structs import ACCESS_DTYPE, Accesses
from sim.registers.map import address, fields
from tests.soak.case import Case, Difference, Operation, Part, config_of, seed, texture

STORED = "image_size", "job.tpl", "job.search", "job.offsets", "job.grid", "job.step"
"""Registers that a read gives back as they were written, and that have no effect of their own."""
SIZE = 33, 25
SIGMA = 1.5
DRAINED = 4000
"""Results popped at most, of the jobs that random writes submit."""


class Bus(Part):
    """See the module."""

    name = "bus"

    def draw(self, rng: random.Random, config: Config) -> list[Operation]:
        drawn: list[Operation] = []
        for _ in range(12):
            kind = rng.choice(("stored", "stored", "any", "any", "work"))
            if kind == "work":
                drawn.append({"do": kind, "seed": seed(rng), "reset": rng.random() < 0.3})
            else:
                drawn.append({"do": kind, "seed": seed(rng), "count": rng.choice((10, 100, 300)),
                              "overlap": rng.choice((1, 1, 2, 6)), "longest": rng.choice((1, 4, 60)),
                              "frame": rng.random() < 0.5})
        drawn.append({"do": "work", "seed": seed(rng), "reset": False})
        return drawn

    def play(self, case: Case) -> Counter[str]:
        config = config_of(case)
        met: Counter[str] = Counter()
        with Device(config, checked=True, power_up=case.power_up) as device:
            for operation in case.operations:
                try:
                    if operation["do"] == "work":
                        _work(device, config, operation)
                    else:
                        _abuse(device, operation, met)
                except DeviceError as error:
                    raise Difference("hang", f"{operation['do']}: {error}") from error
                if device.asserted:
                    raise Difference("assertion", f"an assertion failed in {operation['do']}")
                met[operation["do"]] += 1
        return met


def _mask(register: str) -> int:
    return sum(f.mask for name, f in fields().items() if name.rpartition(".")[0] == register)


def _drawn(rng: random.Random, o: Operation, met: Counter[str]) -> Accesses:
    """Accesses to registers that only store, or to any address. A grid stays small: a large one takes hours."""
    accesses = np.zeros(o["count"], ACCESS_DTYPE)
    mapped = {f.address for f in fields().values()}
    grid = address("job.grid")
    for access in accesses:
        where = address(rng.choice(STORED)) if o["do"] == "stored" else rng.getrandbits(8)
        data, strobes, write = rng.getrandbits(32), rng.choice((15, rng.getrandbits(4))), rng.random() < 0.6
        if o["do"] == "any" and where & 0xFC == grid:
            data &= 0x00010001
        waits = [rng.choice((0, 0, 1, rng.randrange(1 + o["longest"]))) for _ in range(3)]
        access["write"], access["address"], access["data"], access["strobes"] = write, where, data, strobes
        access["wait_address"], access["wait_data"], access["wait_response"] = waits
        kind = "write" if write else "read"
        met[f"unaligned {kind}"] += bool(where & 3)
        met[f"{kind} of no register"] += where & 0xFC not in mapped
        if write:
            met[f"strobes {strobes}"] += 1
            met["address before data"] += waits[0] < waits[1]
            met["data before address"] += waits[0] > waits[1]
    return accesses


def _abuse(device: Device, o: Operation, met: Counter[str]) -> None:
    """Accesses, perhaps while frames arrive; what stored registers answer is known if the accesses do not overlap."""
    rng = random.Random(o["seed"])
    accesses = _drawn(rng, o, met)
    if o["do"] == "any":  # what a stored access left there may be a grid of hours, which any access may start
        device.write_word(address("job.grid"), 0x00010001)
    if o["frame"]:
        device.play(texture(device.size, o["seed"]), rng.randrange(2), 0.2)
    held = {address(register): device.read_word(address(register)) for register in STORED}
    masks = {address(register): _mask(register) for register in STORED}
    broken = device.accesses(accesses, o["overlap"])
    if broken or not accesses["answered"].all():
        raise Difference("protocol", f"{broken} rules broken, {np.count_nonzero(accesses['answered'] == 0)} accesses "
                                     "not answered")
    for number, access in enumerate(accesses):
        where = int(access["address"]) & 0xFC
        if where not in held:
            continue
        if access["write"]:
            lanes = sum(0xFF << 8 * b for b in range(4) if int(access["strobes"]) >> b & 1) & masks[where]
            held[where] = held[where] & ~lanes | int(access["data"]) & lanes
        elif o["overlap"] == 1 and int(access["value"]) != held[where]:
            raise Difference("register", f"access {number}: {where:#x} holds {int(access['value']):#x}, expected "
                                         f"{held[where]:#x}")
    for where, value in held.items():
        seen = device.read_word(where)
        if seen != value:
            raise Difference("register", f"{where:#x} holds {seen:#x} in the end, expected {value:#x}")


def _work(device: Device, config: Config, o: Operation) -> None:
    """The board works: after a reset, or after it has finished what the random accesses started."""
    if o["reset"]:
        device.reset()
    else:
        device.finish_playing()
        for camera in range(config.cameras):
            device.disarm(camera)
        device.abort_frames()
        for _ in range(DRAINED):
            if not (device.read("result.head.valid") or device.read("job.status.busy")
                    or device.read("job.status.waiting")):
                break
            device.write("result.pop", go=1)
        else:
            raise Difference("hang", "jobs do not end")
        if device.stream_waiting:
            device.surface(device.stream_waiting)
    device.set_filter(*kernels(SIGMA, config.radius), SIZE)
    frame = texture(SIZE, o["seed"])
    device.capture({0: 0, 1: 1}, {0: frame, 1: frame})
    plane = sign(frame, SIGMA, config.radius)
    job = Job(0, 3, 2, 9, 8, 1, 1, 0, 7, 6, 5)
    want = run(job, {0: plane, 1: plane}, config, SIZE)
    seen = device.run([job])
    if seen != [want]:
        raise Difference("result", f"{seen}, expected {want}")
    if not np.array_equal(device.plane(1), plane):
        raise Difference("plane", "slot 1")
