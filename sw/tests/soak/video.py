# SPDX-License-Identifier: Apache-2.0
"""Malformed video: short and long lines, missing marks, cut frames, stray pixels, noise, pauses, aborts, resets in
mid-frame, on both cameras at once. Good frames must be captured right, and every drop be counted."""

from __future__ import annotations

import random
from collections import Counter

import numpy as np

from golden.log import kernels, sign
from golden.params import Config
from golden.traffic.video import BAD_KINDS, Item, bad, good, stray
from signum.common.arrays import Image
from sim.board.device import Beats, Device, DeviceError
from tests.soak.case import Case, Difference, Operation, Part, config_of, extreme, seed, texture

WILD = "noise", "starts"
"""Streams whose drops are not predicted: any marks anywhere; a start of frame at every pixel."""
LENGTH = 25
IN_RESET = 20
"""More clocks than a reset lasts on the board."""


class Video(Part):
    """See the module."""

    name = "video"

    def draw(self, rng: random.Random, config: Config) -> list[Operation]:
        drawn: list[Operation] = []
        for _ in range(LENGTH):
            kind = rng.choices(("configure", "stream", "abort", "reset"), (4, 16, 2, 2))[0]
            if kind == "configure":
                drawn.append({"do": kind, "sigma": round(rng.uniform(1.0, 4.0), 3),
                              "size": (extreme(rng, config.min_image, config.max_width),
                                       extreme(rng, config.min_image, config.max_height))})
            elif kind == "stream":
                drawn.append({"do": kind, "cameras": [_stream(rng, config, camera) for camera in rng.choice(
                    ((0,), (1,), (0, 1)))]})
            elif kind == "abort":
                drawn.append({"do": kind, "camera": rng.randrange(2), "sent": rng.random(), "seed": seed(rng)})
            else:
                drawn.append({"do": kind, "clocks": rng.choice((1, 1, 2, 5)), "sent": rng.random(), "seed": seed(rng)})
        return drawn

    def play(self, case: Case) -> Counter[str]:
        with Device(case.config, checked=True, power_up=case.power_up) as device:
            return _Cameras(device, config_of(case)).play(case.operations)


def _stream(rng: random.Random, config: Config, camera: int) -> Operation:
    """What a camera sends: bad pieces and good frames, and the slot that is armed for its first good frame."""
    pieces = [(rng.choice((*BAD_KINDS, *BAD_KINDS, "good", "good", *WILD)), seed(rng))
              for _ in range(rng.randint(0, 5))]
    if rng.random() < 0.2:
        pieces.insert(0, ("stray", seed(rng)))
    return {"camera": camera, "slot": camera + 2 * rng.randrange(config.slots // 2), "pieces": pieces,
            "last": seed(rng), "pause": rng.choice((0.0, 0.0, 0.3, 0.9)), "pause_seed": seed(rng)}


class _Cameras:
    """The cameras of a board, with what the board must have made of their video."""

    def __init__(self, device: Device, config: Config) -> None:
        self.device, self.config = device, config
        self.met: Counter[str] = Counter()
        self.sigma = 1.5
        self.closed = [True] * config.cameras  # the last pixel ended a good frame: a stray one would be a drop
        self._configure((config.max_width, config.max_height))

    def play(self, operations: tuple[Operation, ...]) -> Counter[str]:
        """Carry out all operations.

        Raises:
            Difference: if the board hangs, or a plane or count is wrong.
        """
        for operation in operations:
            try:
                {"configure": self._configured, "stream": self._streams, "abort": self._abort,
                 "reset": self._reset}[operation["do"]](operation)
            except DeviceError as error:
                raise Difference("hang", f"{operation['do']}: {error}") from error
            if self.device.asserted:
                raise Difference("assertion", f"an assertion failed in {operation['do']}")
        return self.met

    def _configure(self, size: tuple[int, int]) -> None:
        self.device.set_filter(*kernels(self.sigma, self.config.radius), size)
        self.planes: dict[int, Image] = {}

    def _configured(self, o: Operation) -> None:
        self.sigma = o["sigma"]
        size = o["size"][0], o["size"][1]
        kept = self.planes if size == self.device.size else {}
        self._configure(size)
        self.planes = kept
        self._check_planes("after a filter change")

    def _streams(self, o: Operation) -> None:
        """Each camera's bad pieces and good frames; at the end all must be captured, counted, and idle."""
        expected: dict[int, list[Item]] = {}
        before = self.device.counters()
        for stream in o["cameras"]:
            camera = stream["camera"]
            wild = any(kind in WILD for kind, _ in stream["pieces"])
            pieces = [*stream["pieces"], ("good", stream["last"])]
            items = [self._item(kind, number) for kind, number in pieces if kind not in WILD]
            if pieces[0][0] == "stray" and not self.closed[camera]:
                items[0].drops = 0
            self.closed[camera] = True
            expected[camera] = [] if wild else items
            self.met["wild stream" if wild else "predicted stream"] += 1
            self.met.update(f"piece {kind}" for kind, _ in pieces)
            if wild:
                self._send(stream, pieces[:-1])
                self.device.finish_playing()
                self.device.tick(40 * self.device.size[0])
                items = items[-1:]
                self.device.arm(stream["slot"], camera)
                self._send(stream, pieces[-1:])
            else:
                self.device.arm(stream["slot"], camera)
                self._send(stream, pieces)
            first = next(i.good for i in items if i.good is not None)
            self.planes[stream["slot"]] = sign(first, self.sigma, self.config.radius)
        self.device.finish_playing()
        self.device.wait_captured(*expected)
        self.device.tick(40 * self.device.size[0])
        if self.device.read("filter.active"):
            raise Difference("active", "a frame is still being received after the last good one")
        after = self.device.counters()
        for camera, wanted in expected.items():
            if wanted:
                seen = tuple(after[f"{name}[{camera}]"] - before[f"{name}[{camera}]"] for name in ("frames", "drops"))
                counts = sum(i.good is not None for i in wanted), sum(i.drops for i in wanted)
                if seen != counts:
                    raise Difference("count", f"camera {camera}: (frames, drops) {seen}, expected {counts}")
        self._check_planes("after " + ", ".join(kind for s in o["cameras"] for kind, _ in s["pieces"]))

    def _item(self, kind: str, number: int) -> Item:
        picture = texture(self.device.size, number)
        if kind == "good":
            return good(picture)
        if kind == "stray":
            return stray(random.Random(number), 1 + number % 50)
        return bad(kind, picture, random.Random(number))

    def _send(self, stream: Operation, pieces: list[tuple[str, int]]) -> None:
        beats = [self._beats(kind, number) for kind, number in pieces]
        if beats:
            self.device.play_beats(np.concatenate(beats), stream["camera"], stream["pause"], stream["pause_seed"])

    def _beats(self, kind: str, number: int) -> Beats:
        rng = np.random.default_rng(number)
        count = int(rng.integers(1, 400))
        if kind == "noise":
            marks = (rng.random((2, count)) < 0.1).astype(np.uint16)
            noise: Beats = (rng.integers(0, 256, count, np.uint16) | marks[0] << 8 | marks[1] << 9).astype(np.uint16)
            return noise
        if kind == "starts":
            return rng.integers(0, 256, count % 60 + 1, np.uint16) | np.uint16(1 << 8)
        beats = self._item(kind, number).beats
        return np.array([data | user << 8 | last << 9 for data, user, last in beats], np.uint16)

    def _part(self, o: Operation) -> Beats:
        beats = self._beats("good", o["seed"])
        return beats[:1 + int(o["sent"] * (len(beats) - 2))]

    def _abort(self, o: Operation) -> None:
        """A frame is aborted in the middle; the slots keep their frames."""
        drops = self.device.counters()[f"drops[{o['camera']}]"]
        self.device.play_beats(self._part(o), o["camera"])
        self.device.finish_playing()
        aborted = self.device.abort_frames()
        self.device.tick(40 * self.device.size[0])
        self.closed[o["camera"]] = False
        if aborted != [o["camera"]] or self.device.counters()[f"drops[{o['camera']}]"] != drops + 1:
            raise Difference("abort", f"aborted {aborted}, expected camera {o['camera']} and one drop")
        self.met["abort"] += 1
        self._check_planes("after an abort")

    def _reset(self, o: Operation) -> None:
        """A reset in mid-frame; the rest of the frame, one pixel or more, arrives after it."""
        size = self.device.size
        beats = self._beats("good", o["seed"])
        for camera in range(2):
            self.device.play_beats(beats, camera)
        self.device.tick(int(o["sent"] * (len(beats) - IN_RESET)))
        self.device.restart(o["clocks"])
        self.device.finish_playing()
        self.closed = [False] * self.config.cameras
        self.met["reset in mid-frame"] += 1
        self._configure(size)

    def _check_planes(self, when: str) -> None:
        for slot, plane in self.planes.items():
            if not np.array_equal(self.device.plane(slot), plane):
                raise Difference("plane", f"slot {slot} {when}")
