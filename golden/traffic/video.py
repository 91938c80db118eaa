# SPDX-License-Identifier: Apache-2.0
"""Good and bad video streams as beats of an AXI4-Stream video input, and what the front end must make of them."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from golden.cycle.bits import pack_coefs
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.log import Coefs, Image, binarise

Beat = tuple[int, int, int]
"""tdata, tuser, tlast."""

BAD_KINDS = ("short_line", "long_line", "cut_line", "cut_frame", "extra_line", "one_beat")


@dataclass
class Item:
    """A piece of a video stream: its beats, the frame to be accepted if any, and the drops to be counted."""

    beats: list[Beat]
    good: Image | None = None
    drops: int = 0
    drain_before: bool = False
    """Wait until the front end is idle, so that the beats do not belong to the frame before."""


def texture(rng: random.Random, width: int, height: int) -> Image:
    """Random image: noise of full, of highest or of lowest contrast, or flat patches, where responses are exactly 0."""
    source = np.random.default_rng(rng.getrandbits(32))
    kind = rng.randrange(4)
    if kind == 0:
        return source.integers(0, 256, (height, width), dtype=np.uint8)
    if kind == 1:
        return (source.integers(0, 2, (height, width), dtype=np.uint8) * 255).astype(np.uint8)
    if kind == 2:
        return source.integers(126, 130, (height, width), dtype=np.uint8)
    patches = source.integers(0, 256, (-(-height // 6), -(-width // 6)), dtype=np.uint8)
    return np.ascontiguousarray(np.kron(patches, np.ones((6, 6), np.uint8))[:height, :width])


def _beats(image: Image) -> list[list[Beat]]:
    last = image.shape[1] - 1
    return [[(int(p), int(y == 0 and x == 0), int(x == last)) for x, p in enumerate(row)]
            for y, row in enumerate(image)]


def good(image: Image) -> Item:
    """A correct frame."""
    return Item([b for line in _beats(image) for b in line], good=image)


def bad(kind: str, image: Image, rng: random.Random) -> Item:
    """A broken frame of one of BAD_KINDS, to be dropped once.

    Raises:
        ValueError: for an unknown kind.
    """
    lines = _beats(image)
    height, width = image.shape
    y = rng.randrange(height)
    if kind == "short_line":
        cut = rng.randrange(int(y == 0), width - 1)
        lines[y] = [*lines[y][:cut], (lines[y][cut][0], int(y == 0 and cut == 0), 1)]
    elif kind == "long_line":
        lines[y] = [*[(d, u, 0) for d, u, _ in lines[y]], (rng.getrandbits(8), 0, 1)]
    elif kind == "cut_line":
        lines = [*lines[:y], lines[y][:rng.randrange(1, width)]]
    elif kind == "cut_frame":
        lines = lines[:rng.randrange(1, height)]
    elif kind == "extra_line":
        lines = [*lines, [(d, 0, e) for d, _, e in lines[-1]]]
    elif kind == "one_beat":
        lines = [[(rng.getrandbits(8), 1, 1)]]
    else:
        raise ValueError(f"unknown kind of bad frame {kind!r}")
    return Item([b for line in lines for b in line], drops=1)


def stray(rng: random.Random, beats: int) -> Item:
    """Pixels without a start of frame while the front end is idle: counted as one dropped frame."""
    return Item([(rng.getrandbits(8), 0, rng.getrandbits(1)) for _ in range(beats)], drops=1, drain_before=True)


@dataclass
class VideoRecord:
    """The output of the front end: complete planes in order, and counts of the pulses."""

    group_bits: int
    width: int
    planes: list[Image] = field(default_factory=list)
    starts: int = 0
    aborts: int = 0
    drops: int = 0
    accepted: int = 0
    stalled: int = 0
    words: int = 0
    first_word: list[int] = field(default_factory=list)
    clock: int = 0
    _open: bool = False
    _rows: list[list[int]] = field(default_factory=list)
    _row: list[int] = field(default_factory=list)
    _fresh: bool = False

    def observe(self, i: Inputs, out: Outputs) -> None:
        """Take the outputs of a clock.

        Raises:
            AssertionError: if the pulses come in a wrong order or a row is padded wrongly.
        """
        if i["rst_i"]:  # frames in flight are lost
            self._open = False
            self.clock += 1
            return
        self.drops += out["dropped_o"] or 0
        self.accepted += out["accepted_o"] or 0
        self.stalled += bool(i["tvalid_i"] and not out["tready_o"])
        if out["frame_start_o"]:
            assert not self._open, "a frame starts inside a frame"
            self.starts += 1
            self._open, self._rows, self._row, self._fresh = True, [], [], True
        if out["word_valid_o"]:
            assert self._open, "a word outside a frame"
            self.words += 1
            if self._fresh:
                self.first_word.append(self.clock)
                self._fresh = False
            word = out["word_data_o"]
            assert word is not None
            self._row += [word >> b & 1 for b in range(self.group_bits)]
            if out["word_last_o"]:
                assert not any(self._row[self.width:]), "padding is not zero"
                assert -(-self.width // self.group_bits) * self.group_bits == len(self._row)
                self._rows.append(self._row[:self.width])
                self._row = []
        if out["frame_done_o"]:
            assert self._open and not self._row
            self.planes.append(np.array(self._rows, np.uint8))
            self._open = False
        if out["frame_abort_o"]:
            assert self._open, "an abort outside a frame"
            self.aborts += 1
            self._open = False
        self.clock += 1

    def check(self, items: list[Item], g: Coefs, g2: Coefs) -> None:
        """Compare planes and counts with the frame level for `items` under the kernels `g` and `g2`.

        Raises:
            AssertionError: if a plane, the number of frames, or a count differs.
        """
        wanted = [binarise(i.good, g, g2) for i in items if i.good is not None]
        assert len(self.planes) == len(wanted) == self.accepted > 0
        for got, want in zip(self.planes, wanted, strict=True):
            np.testing.assert_array_equal(got, want)
        assert self.drops == sum(i.drops for i in items)
        assert self.starts == self.aborts + self.accepted


def settings_of(width: int, height: int, g: Coefs, g2: Coefs) -> Inputs:
    """Image size in pixels and kernels as inputs of the front end."""
    return {"width_i": width, "height_i": height, "g_i": pack_coefs(g), "g2_i": pack_coefs(g2)}


def play(items: list[Item], settings: Inputs, offer: Iterator[int], rng: random.Random, gap: int = 0,
         hold: Iterator[int] | None = None, abort: Iterator[int] | None = None, most: int = 200_000) -> Stimulus:
    """Stimulus: the items one after another, then until the front end is idle.

    Data wires are random while nothing is offered.

    Args:
        items: what to send.
        settings: further inputs, constant (see `settings_of`).
        offer: whether the source is ready to send in a clock.
        rng: of pauses and idle wires.
        gap: longest random pause between items, clocks.
        hold: values of `hold_i`; 0 throughout by default.
        abort: values of `abort_i`; 0 throughout by default.
        most: clocks allowed.

    Raises:
        AssertionError: if the stream does not move or the front end does not become idle.
    """
    idle_needed = 3

    def beat(b: Beat | None) -> Inputs:
        data, user, last = b if b else (rng.getrandbits(8), rng.getrandbits(1), rng.getrandbits(1))
        return {**settings, "rst_i": 0, "tvalid_i": int(b is not None), "tdata_i": data, "tuser_i": user,
                "tlast_i": last, "hold_i": next(hold) if hold else 0, "abort_i": next(abort) if abort else 0}

    clocks = 0
    for item in items:
        for _ in range(rng.randint(0, gap) if gap else 0):
            yield beat(None)
        quiet = 0 if item.drain_before else idle_needed
        while quiet < idle_needed:
            out = yield beat(None)
            quiet = 0 if out["busy_o"] else quiet + 1
        for b in item.beats:
            held = False
            while True:
                held = held or bool(next(offer))
                out = yield beat(b if held else None)
                clocks += 1
                assert clocks < most, "the stream does not move"
                if held and out["tready_o"]:
                    break
    quiet = 0
    while quiet < idle_needed:
        out = yield beat(None)
        clocks += 1
        assert clocks < most, "the front end does not become idle"
        quiet = 0 if out["busy_o"] else quiet + 1
