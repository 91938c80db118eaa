# SPDX-License-Identifier: Apache-2.0
"""The surroundings of the whole board as a stimulus: host registers, cameras and surface sink, clock by clock.

A scenario is a generator that yields once per clock and calls the methods here, most of which are generators too.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Callable, Generator, Iterator
from dataclasses import astuple

from cocotb_tests.env.axil import AxilMaster
from golden.correlate import Job, Neighbours, Result, Status
from golden.cycle.board import RESET_END
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.log import Image, kernels
from golden.params import Config
from golden.traffic.stalls import ready_pattern
from golden.traffic.video import Beat, good
from sim.registers.map import address, field, word

Script = Generator[None, None, None]
"""A scenario or a part of one: yields once per clock."""
LIMIT = 30_000
"""Longest wait, clocks."""


class Host:
    """Registers, cameras and surface sink of a board.

    Attributes:
        STREAM: what the ports of the board's output stream begin with.
        streamed: what streamed out: data, first, last.

    Args:
        config: the build.
        rng: of stalls and of the values on idle wires.
        video: stall shape of the cameras.
        sink: stall shape of the surface sink.
        bus: stall shape of the register responses.
    """

    STREAM = "surf"

    def __init__(self, config: Config, rng: random.Random, video: str = "none", sink: str = "none",
                 bus: str = "none") -> None:
        self.config, self.rng = config, rng
        self.master = AxilMaster(ready_pattern(bus, rng))
        self.offer = [ready_pattern(video, rng) for _ in range(config.cameras)]
        self.take: Iterator[int] = ready_pattern(sink, rng)
        self.beats: list[deque[Beat]] = [deque() for _ in range(config.cameras)]
        self.held = [False] * config.cameras
        self.streamed: list[tuple[int, int, int]] = []
        self.results: list[Result] = []
        self.size = (config.max_width, config.max_height)
        self.rst = 0
        self.deaf = False  # the outputs of the board are ignored, during and after a reset
        self.irq = 0
        self.stalls = dict.fromkeys(("video", "stream"), 0)
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
                        "vid_tuser_i": user, "vid_tlast_i": last, f"{self.STREAM}_tready_i": next(self.take)}
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
        if out[f"{self.STREAM}_tvalid_o"]:
            if i[f"{self.STREAM}_tready_i"]:
                data, user, last = (out[f"{self.STREAM}_t{name}_o"] or 0 for name in ("data", "user", "last"))
                self.streamed.append((data, user, last))
            else:
                self.stalls["stream"] += 1
        self.irq = out["irq_o"] or 0

    def until(self, done: Callable[[], bool], what: str) -> Script:
        """Wait until `done()`.

        Raises:
            AssertionError: naming `what`, after LIMIT clocks.
        """
        for _ in range(LIMIT):
            if done():
                return
            yield
        raise AssertionError(f"{what}: not within {LIMIT} clocks")

    def pause(self, clocks: int) -> Script:
        """Wait for `clocks` clocks."""
        for _ in range(clocks):
            yield

    def reset(self, clocks: int = 2) -> Script:
        """Reset the board for `clocks` clocks, whatever it does; the cameras lose the rest of their frames."""
        self.rst, self.deaf = 1, True
        for beats in self.beats:
            beats.clear()
        self.held = [False] * self.config.cameras
        self.streamed.clear()
        self.size = (self.config.max_width, self.config.max_height)
        # The reset ends every bus access; no request is asserted during it.
        self.master.reset()
        yield from self.pause(clocks)
        self.rst = 0
        yield from self.pause(RESET_END)
        self.deaf = False

    # Registers
    def read(self, path: str) -> Generator[None, None, int]:
        """A field's value."""
        place = field(path)
        access = self.master.read(place.address)
        yield from self.until(lambda: access.done, f"read of {path}")
        assert access.data is not None, f"{path} is undefined"
        return place.unpack(access.data)

    def write(self, register: str, **values: int) -> Script:
        """Write a register; fields that are not given become 0."""
        access = self.master.write(address(register), word(register, **values))
        yield from self.until(lambda: access.done, f"write of {register}")

    def set_up(self, sigma: float, size: tuple[int, int]) -> Script:
        """Write coefficients and image size (width, height), and wait until they are in use."""
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
        self.beats[camera].extend(good(image).beats)

    def arm(self, camera: int, slot: int) -> Script:
        """Request the capture of the camera's next frame into `slot`."""
        yield from self.write("capture", camera=camera, slot=slot, go=1)
        assert not (yield from self.read("slot_status.refused"))

    def captured(self) -> Script:
        """Wait until no capture is pending."""
        while (yield from self.read("slot_status.armed")):
            pass

    def plane(self, slot: int) -> Generator[None, None, list[list[int]]]:
        """The sign bits of a slot, (height, width) rows of 0/1, read back through the peek port."""
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
        """Submit a job, or a grid of `count` jobs `step` pixels apart, whether the board is ready or not."""
        (tpl_slot, tpl_x, tpl_y, width, height, slot, x, y, across, down, tag, surface) = map(int, astuple(job))
        for register, values in (
                ("job.tpl", {"slot": tpl_slot, "x": tpl_x, "y": tpl_y}),
                ("job.window", {"width": width, "height": height}),
                ("job.search", {"slot": slot, "x": x, "y": y}), ("job.offsets", {"across": across, "down": down}),
                ("job.grid", {"across": count[0], "down": count[1]}), ("job.step", {"x": step[0], "y": step[1]})):
            self.master.write(address(register), word(register, **values))
        yield from self.write("job.submit", tag=tag, surface=surface, go=1)

    def collect(self, count: int) -> Script:
        """Read and pop the next `count` results into `results`."""
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
            self.results.append(Result(tag, Status(status), x, y, score, _neighbours(around), runner_up))


def _neighbours(values: list[int]) -> Neighbours:
    """Eight scores as a tuple of that length."""
    n0, n1, n2, n3, n4, n5, n6, n7 = values
    return n0, n1, n2, n3, n4, n5, n6, n7
