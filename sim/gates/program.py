# SPDX-License-Identifier: Apache-2.0
"""What `tb_gates.sv` plays to a board: register accesses, a frame from each camera, ten jobs; and what must come of
them."""

from __future__ import annotations

import random
from dataclasses import astuple, dataclass, field

from golden.correlate import Job, Plane, Result, run, surface
from golden.log import Image, kernels, sign
from golden.params import NO_SCORE, Config
from golden.traffic.peak import surface_beats
from golden.traffic.video import texture
from sim.registers.map import address, fields, word

END, WRITE, CHECK, POLL, FRAME = range(5)
SIGMA = 1.5
JOBS = 10
SEED = 1


@dataclass
class Program:
    """The files of a run.

    Attributes:
        size: (width, height) of the frames, pixels.
        steps: (operation, address, data, mask).
        frames: of the cameras, uint8 of shape (H, W).
        beats: of the surface: score, first, last.
    """

    size: tuple[int, int]
    steps: list[tuple[int, int, int, int]] = field(default_factory=list)
    frames: list[Image] = field(default_factory=list)
    beats: list[tuple[int, int, int]] = field(default_factory=list)

    def write(self, register: str, **values: int) -> None:
        """Write a register; fields that are not given become 0."""
        self.steps.append((WRITE, address(register), word(register, **values), 0))

    def expect(self, register: str, poll: bool = False, **values: int) -> None:
        """Read a register, whose fields must have these values; with `poll` again and again until they have."""
        mask = sum(fields()[f"{register}.{name}"].mask for name in values)
        self.steps.append((POLL if poll else CHECK, address(register), word(register, **values), mask))

    def show(self, camera: int, frame: Image) -> None:
        """Let a camera send its frame."""
        self.frames.append(frame)
        self.steps.append((FRAME, camera, 0, 0))

    def files(self) -> dict[str, str]:
        """Texts of the files that `tb_gates.sv` reads, by name."""
        steps = [*self.steps, (END, 0, 0, 0)]
        return {
            "program.hex": "".join(f"{op:02x}{at:04x}{data:08x}{mask:08x}\n" for op, at, data, mask in steps),
            **{f"frame{k}.hex": "".join(f"{pixel:02x}\n" for pixel in frame.flat)
               for k, frame in enumerate(self.frames)},
            "surface.hex": "".join(f"{last << 17 | first << 16 | score:05x}\n" for score, first, last in self.beats)}


def jobs(config: Config, size: tuple[int, int], rng: random.Random) -> list[Job]:
    """JOBS jobs between the slots 0 and 1: two are refused, some stream their scores."""
    made = []
    for tag in range(JOBS):
        width, height = (rng.randint(config.min_window, config.max_window) for _ in range(2))
        across, down = rng.randint(1, min(8, size[0] - width + 1)), rng.randint(1, min(5, size[1] - height + 1))
        made.append(Job(
            tag % 2, rng.randint(0, size[0] - width), rng.randint(0, size[1] - height), width, height, tag // 2 % 2,
            rng.randint(0, size[0] - width - across + 1), rng.randint(0, size[1] - height - down + 1), across,
            0 if tag == 3 else down, tag, tag % 3 == 0) if tag != 6 else Job(5, 0, 0, 4, 4, 0, 0, 0, 1, 1, tag))
    return made


def _result(program: Program, result: Result) -> None:
    """Wait for a result, compare it and take it."""
    program.expect("result.head", poll=True, valid=1)
    program.expect("result.head", tag=result.tag, status=int(result.status), valid=1)
    program.expect("result.best", x=result.best_x, y=result.best_y)
    program.expect("result.scores", score=result.score, runner_up=result.runner_up)
    for k in range(4):
        even, odd = result.neighbours[2 * k:2 * k + 2]
        program.expect(f"result.neighbour[{k}]", even=even, odd=odd)
    program.write("result.pop", go=1)


def _plane(program: Program, plane: Plane, slot: int, config: Config) -> None:
    """Read the first, middle and last row of a slot back and compare them; the jobs' results depend on all of it."""
    for y in (0, len(plane) // 2, len(plane) - 1):
        row = plane[y]
        program.write("peek_address", word=slot * config.slot_words + y * config.words_per_row, go=1)
        for x in range(0, len(row) - config.group_bits + 1, config.group_bits):
            program.expect("peek_data", value=sum(int(bit) << k for k, bit in enumerate(row[x:x + config.group_bits])))


def program(config: Config, size: tuple[int, int]) -> Program:
    """Settings, a frame of `size` = (width, height) from each camera at the same time, the planes, ten jobs."""
    rng = random.Random(SEED)
    made = Program(size)
    made.expect("id", value=0x534C4F47)
    for second, kernel in enumerate(kernels(SIGMA, config.radius)):
        for index, value in enumerate(kernel):
            made.write("coef", value=int(value), second=second, index=index, go=1)
    made.write("image_size", width=size[0], height=size[1])
    made.write("filter", go=1)
    made.expect("filter", poll=True, busy=0)
    made.write("irq_enable", result=1, capture=1, drop=1, overflow=1)
    frames = [texture(rng, *size) for _ in range(config.cameras)]
    planes = {slot: sign(frame, SIGMA, config.radius) for slot, frame in enumerate(frames)}
    for camera, frame in enumerate(frames):
        made.write("capture", camera=camera, slot=camera, go=1)
        made.show(camera, frame)
    made.expect("slot_status", poll=True, armed=0, valid=2**config.cameras - 1)
    for slot, plane in planes.items():
        _plane(made, plane, slot, config)
    listed = jobs(config, size, rng)
    results = [run(job, planes, config, size) for job in listed]
    waiting = list(results)
    for k, job in enumerate(listed):
        (tpl_slot, tpl_x, tpl_y, width, height, slot, x, y, across, down, tag, stream) = map(int, astuple(job))
        made.write("job.tpl", slot=tpl_slot, x=tpl_x, y=tpl_y)
        made.write("job.window", width=width, height=height)
        made.write("job.search", slot=slot, x=x, y=y)
        made.write("job.offsets", across=across, down=down)
        made.expect("job.status", poll=True, ready=1)
        made.write("job.submit", tag=tag, surface=stream, go=1)
        if job.surface and results[k].score != NO_SCORE:
            made.beats += surface_beats(surface(planes[job.tpl_slot], planes[job.search_slot], job))
        if k >= config.result_depth:
            _result(made, waiting.pop(0))
    for result in waiting:
        _result(made, result)
    made.expect("counter.overflows", value=0)
    made.expect("irq_status", result=0, capture=1, drop=0, overflow=0)
    return made
