"""A host of the whole board as part of a stimulus: registers, cameras and surface sink, played clock by clock.

A scenario is a generator that yields once a clock and calls the methods here, most of which are generators as well.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Callable, Generator, Iterator
from dataclasses import astuple

from cocotb_tests.env.axil import AxilMaster
from golden.correlate import Job, Neighbours, Result, Status
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.log import Image, kernels
from golden.params import Config
from golden.traffic.stalls import willing
from golden.traffic.video import Beat
from sim.registers.map import address, fields, word

Script = Generator[None, None, None]
RESET_DELAY = 3
"""Clocks that a reset takes to reach the board's blocks."""
LIMIT = 30_000
"""Clocks a wait may take."""


class Host:
    """The board's surroundings.

    Args:
        config: the build.
        rng: of stalls and of garbage on idle wires.
        video: stall shape of the cameras.
        sink: stall shape of the surface's receiver.
        bus: stall shape of the register responses.
    """

    def __init__(self, config: Config, rng: random.Random, video: str = "none", sink: str = "none",
                 bus: str = "none") -> None:
        self.config, self.rng = config, rng
        self.master = AxilMaster(willing(bus, rng))
        self.offer = [willing(video, rng) for _ in range(config.cameras)]
        self.take: Iterator[int] = willing(sink, rng)
        self.beats: list[deque[Beat]] = [deque() for _ in range(config.cameras)]
        self.held = [False] * config.cameras
        self.surface: list[tuple[int, int, int]] = []
        self.results: list[Result] = []
        self.size = (config.max_width, config.max_height)
        self.rst = 0
        self.deaf = False  # what the board says means nothing
        self.irq = 0
        self.stalls = dict.fromkeys(("video", "surface"), 0)
        self._inputs: Inputs = {}

    def play(self, script: Script) -> Stimulus:
        """The stimulus that carries out `script`."""
        for _ in script:
            out = yield self._drive()
            self._observe(out)

    def _drive(self) -> Inputs:
        data = user = last = valid = 0
        for c, beats in enumerate(self.beats):
            self.held[c] = bool(beats) and (self.held[c] or bool(next(self.offer[c])))
            beat = beats[0] if self.held[c] else (self.rng.getrandbits(8), self.rng.getrandbits(1), 0)
            data |= beat[0] << 8 * c
            user |= beat[1] << c
            last |= beat[2] << c
            valid |= int(self.held[c]) << c
        self._inputs = {**self.master.drive(), "rst_i": self.rst, "vid_tdata_i": data, "vid_tvalid_i": valid,
                        "vid_tuser_i": user, "vid_tlast_i": last, "surf_tready_i": next(self.take)}
        return self._inputs

    def _observe(self, out: Outputs) -> None:
        i = self._inputs
        if self.deaf:
            return
        self.master.observe(out)
        ready = out["vid_tready_o"]
        assert ready is not None
        for c, beats in enumerate(self.beats):
            if i["vid_tvalid_i"] >> c & 1:
                if ready >> c & 1:
                    beats.popleft()
                    self.held[c] = False
                else:
                    self.stalls["video"] += 1
        if out["surf_tvalid_o"]:
            if i["surf_tready_i"]:
                self.surface.append((out["surf_tdata_o"] or 0, out["surf_tuser_o"] or 0, out["surf_tlast_o"] or 0))
            else:
                self.stalls["surface"] += 1
        self.irq = out["irq_o"] or 0

    def until(self, done: Callable[[], bool], what: str) -> Script:
        """Wait."""
        for _ in range(LIMIT):
            if done():
                return
            yield
        raise AssertionError(f"{what}: not within {LIMIT} clocks")

    def pause(self, clocks: int) -> Script:
        """Let time pass."""
        for _ in range(clocks):
            yield

    def reset(self, clocks: int = 2) -> Script:
        """Reset the board, whatever is under way; the cameras lose the rest of their frames."""
        self.rst, self.deaf = 1, True
        for beats in self.beats:
            beats.clear()
        self.held = [False] * self.config.cameras
        self.surface.clear()
        self.size = (self.config.max_width, self.config.max_height)
        # What the bus had under way is gone; its request wires fall with the reset.
        self.master.reset()
        yield from self.pause(clocks)
        self.rst = 0
        yield from self.pause(RESET_DELAY)
        self.deaf = False

    # Registers
    def read(self, field: str) -> Generator[None, None, int]:
        """A field's value."""
        access = self.master.read(fields()[field].address)
        yield from self.until(lambda: access.done, f"read of {field}")
        assert access.data is not None, f"{field} is undefined"
        return fields()[field].unpack(access.data)

    def write(self, register: str, **values: int) -> Script:
        """Write a register; fields not named become 0."""
        access = self.master.write(address(register), word(register, **values))
        yield from self.until(lambda: access.done, f"write of {register}")

    def set_up(self, sigma: float, size: tuple[int, int]) -> Script:
        """Filter and image size, and wait until they are in use."""
        for second, kernel in enumerate(kernels(sigma, self.config.radius)):
            for index, value in enumerate(kernel):
                self.master.write(address("coef"), word("coef", value=int(value), second=second, index=index, go=1))
        yield from self.write("image_size", width=size[0], height=size[1])
        yield from self.write("filter", go=1)
        while (yield from self.read("filter.busy")):
            pass
        assert not (yield from self.read("filter.size_error"))
        self.size = size

    # Frames
    def show(self, camera: int, image: Image) -> None:
        """Queue a good frame on a camera."""
        last = image.shape[1] - 1
        self.beats[camera].extend((int(p), int(y == 0 and x == 0), int(x == last))
                                  for y, line in enumerate(image) for x, p in enumerate(line))

    def arm(self, camera: int, slot: int) -> Script:
        """Ask for the camera's next frame."""
        yield from self.write("capture", camera=camera, slot=slot, go=1)
        assert not (yield from self.read("slot_status.refused"))

    def captured(self) -> Script:
        """Wait until no camera has a request left."""
        while (yield from self.read("slot_status.armed")):
            pass

    def plane(self, slot: int) -> Generator[None, None, list[list[int]]]:
        """A slot's sign bits."""
        c = self.config
        rows: list[list[int]] = []
        for y in range(self.size[1]):
            yield from self.write("peek_address", word=slot * c.slot_words + y * c.words_per_row, go=1)
            row: list[int] = []
            for _ in range(-(-self.size[0] // c.group_bits)):
                bits = yield from self.read("peek_data.value")
                row += [bits >> b & 1 for b in range(c.group_bits)]
            rows.append(row[:self.size[0]])
        return rows

    # Jobs
    def submit(self, job: Job, count: tuple[int, int] = (1, 1), step: tuple[int, int] = (0, 0)) -> Script:
        """Hand a job or grid to the board, ready or not."""
        (tpl_slot, tpl_x, tpl_y, width, height, slot, x, y, across, down, tag, surface) = map(int, astuple(job))
        for register, values in (
                ("job.tpl", {"slot": tpl_slot, "x": tpl_x, "y": tpl_y}),
                ("job.window", {"width": width, "height": height}),
                ("job.search", {"slot": slot, "x": x, "y": y}), ("job.offsets", {"across": across, "down": down}),
                ("job.grid", {"across": count[0], "down": count[1]}), ("job.step", {"x": step[0], "y": step[1]})):
            self.master.write(address(register), word(register, **values))
        yield from self.write("job.submit", tag=tag, surface=surface, go=1)

    def collect(self, count: int) -> Script:
        """Take the next `count` results off the board into `results`."""
        for _ in range(count):
            while not (yield from self.read("result.head.valid")):
                pass
            tag = yield from self.read("result.head.tag")
            status = yield from self.read("result.head.status")
            x = yield from self.read("result.best.x")
            y = yield from self.read("result.best.y")
            score = yield from self.read("result.scores.score")
            around: list[int] = []
            for k in range(4):
                for half in ("even", "odd"):
                    around.append((yield from self.read(f"result.neighbour[{k}].{half}")))
            runner_up = yield from self.read("result.scores.runner_up")
            yield from self.write("result.pop", go=1)
            self.results.append(Result(tag, Status(status), x, y, score, neighbours(around), runner_up))


def neighbours(values: list[int]) -> Neighbours:
    """Eight scores as a tuple of that length."""
    n0, n1, n2, n3, n4, n5, n6, n7 = values
    return n0, n1, n2, n3, n4, n5, n6, n7
