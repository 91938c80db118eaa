# SPDX-License-Identifier: Apache-2.0
"""Random windows for `slog_operands` and `slog_array`, with their mismatches by plain counting."""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Iterator

import numpy as np

from golden.correlate import Plane
from golden.cycle.array.timing import REUSE_CLOCKS, array_latency, drain_clocks
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.structs import STEP


def _bits(words: list[int], width: int) -> Plane:
    """Words of `width` bits, the first leftmost, as a row of 0/1 from left to right."""
    return np.array([w >> b & 1 for w in words for b in range(width)], dtype=np.uint8)


class WindowTraffic:
    """Rounds of one window each: its template is loaded during the round before, then passes at random places.

    `stimulus` yields the write port, `step_i` and `mask_i`; `expected` collects the mismatches of each pass, in order,
    `observe` what the array gives. Windows are paired or wide, of any width and height; the rest of the ring is
    rewritten meanwhile.
    """

    def __init__(self, rng: random.Random, group_bits: int, ring_rows: int, words_per_row: int,
                 bubbles: Iterator[int]) -> None:
        self.rng, self.bubbles = rng, bubbles
        self.group_bits, self.pitch, self.lanes = group_bits, group_bits // 2, group_bits // 2 + 1
        self.ring_rows, self.words = ring_rows, 4 * (-(-words_per_row // 4))
        self.memory = np.zeros((ring_rows, self.words * group_bits), dtype=np.uint8)
        self.writes: deque[dict[str, int]] = deque()
        self.expected: list[list[int]] = []
        self.scores: list[tuple[int, int]] = []  # clock and value of each mismatch seen
        self.due: list[int] = []  # clocks in which a mismatch is due
        self.clocks = 0
        self.bank = 0
        self.rows: frozenset[int] = frozenset()  # ring rows in use by the current round
        self.quiet = 0  # clocks since a step
        self.until_last = 0  # clocks before the next pass may end
        self.write_wait = 0  # clocks before the words of the last round may be overwritten
        self.shape = (False, 0)  # wide, width of the latest window
        self.mask = 0

    def stimulus(self, rounds: int, passes: int) -> Stimulus:
        """`rounds` windows of about `passes` passes each, until the last score is out."""
        g = self.group_bits
        for row in range(self.ring_rows):
            self._fill(row)
        window = self._window()
        while self.writes:
            yield self._clock(None)
        for r in range(rounds):
            template, wide, bank = window
            height, width = template.shape
            base = self.rng.randrange(self.ring_rows)
            # The window moves down a few rows; the rest of the ring is free to be rewritten.
            spare = self.rng.randint(0, min(3, self.ring_rows - height))
            self.rows = frozenset((base + d) % self.ring_rows for d in range(height + spare))
            mask = (1 << width) - 1 if wide else ((1 << width) - 1) << g | (1 << width) - 1
            if mask != self.mask:
                while self.quiet < drain_clocks(g, self.lanes):
                    yield self._clock(None)
                self.mask = mask
            if r + 1 < rounds:
                window = self._window()
                for row in self.rng.sample(sorted(set(range(self.ring_rows)) - self.rows),
                                           min(4, self.ring_rows - height - spare)):
                    self._fill(row)
            for _ in range(self.rng.randint(1, 2 * passes)):
                yield from self._pass(template, wide, bank, (base + self.rng.randint(0, spare)) % self.ring_rows)
            while self.writes:
                yield self._clock(None)
            self.write_wait = REUSE_CLOCKS - 1
        for _ in range(self.ring_rows + 8 * g + 60):
            yield self._clock(None)

    def observe(self, i: Inputs, out: Outputs) -> None:
        """Take the inputs and outputs of a clock: the mismatches seen and the clocks they are due in."""
        step = STEP.unpack(i["step_i"])
        if step["valid"] and step["last"]:
            self.due.extend(self.clocks + array_latency(self.group_bits) + k for k in range(step["lanes"]))
        if out["mismatch_valid_o"]:
            self.scores.append((self.clocks, out["mismatch_o"]))
        self.clocks += 1

    def check(self) -> None:
        """Compare the mismatches seen with plain counting and with the latency.

        Raises:
            AssertionError: if a value, the order or a clock differs.
        """
        assert [value for _, value in self.scores] == [value for lanes in self.expected for value in lanes]
        assert [clock for clock, _ in self.scores] == self.due

    def _pass(self, template: Plane, wide: bool, bank: int,
              top: int) -> Stimulus:
        height, width = template.shape
        lanes = self.rng.choice((1, self.lanes, self.rng.randint(1, self.lanes)))
        chunks = (self.words * self.group_bits - width - lanes + 1) // self.pitch
        chunk = self.rng.randint(0, min(chunks, 2 * self.words - 5))
        left = chunk * self.pitch
        rows = self.memory[[(top + d) % self.ring_rows for d in range(height)]]
        self.expected.append([int(np.count_nonzero(template != rows[:, left + k:left + k + width]))
                              for k in range(lanes)])
        steps = height if wide else -(-height // 2)
        gap = self.rng.choice((0, 0, 1, self.rng.randint(0, 9)))
        while gap or (self.until_last > steps - 1):
            gap = max(gap - 1, 0)
            yield self._clock(None)
        for s in range(steps):
            while not next(self.bubbles):
                yield self._clock(None)
            last = s == steps - 1
            yield self._clock({
                "valid": 1, "first": int(s == 0), "last": int(last), "wide": int(wide),
                "row_b": int(wide or not last or height % 2 == 0), "bank": bank, "tpl_step": s,
                "ring_row": (top + (s if wide else 2 * s)) % self.ring_rows, "chunk": chunk, "lanes": lanes})
        self.until_last = lanes - 1

    def _clock(self, step: dict[str, int] | None) -> Inputs:
        """Inputs of one clock: `step` or noise, and often the next write if there is one."""
        self.quiet = 0 if step else self.quiet + 1
        self.until_last = max(self.until_last - 1, 0)
        noise = {name: self.rng.getrandbits(bits) for name, bits in STEP.fields}
        write = None
        if self.write_wait:
            self.write_wait -= 1
        elif self.writes and self.rng.random() < 0.9:
            write = self.writes.popleft()
        idle = {"wr_tpl_i": self.rng.getrandbits(1), "wr_wide_i": self.rng.getrandbits(1), "wr_bank_i": 0,
                "wr_row_i": 0, "wr_word_i": 0, "wr_data_i": self.rng.getrandbits(self.group_bits)}
        return {"rst_i": 0, "wr_valid_i": int(write is not None), **(write or idle), "mask_i": self.mask,
                "step_i": STEP.pack(step or {**noise, "valid": 0})}

    def _fill(self, row: int) -> None:
        """Queue the writes of a ring row of random words."""
        words = [self.rng.getrandbits(self.group_bits) for _ in range(self.words)]
        self.memory[row] = _bits(words, self.group_bits)
        for k, word in enumerate(words):
            self.writes.append({"wr_tpl_i": 0, "wr_wide_i": self.rng.getrandbits(1),
                                "wr_bank_i": self.rng.getrandbits(1), "wr_row_i": row, "wr_word_i": k,
                                "wr_data_i": word})

    def _window(self) -> tuple[Plane, bool, int]:
        """Queue the writes of a random template for the unused bank: (bits (height, width), wide, bank)."""
        g = self.group_bits
        if self.shape[1] == 0 or self.rng.random() < 0.7:
            wide = self.rng.random() < 0.5
            width = self.rng.choice((g + 1, 2 * g, self.rng.randint(g + 1, 2 * g)) if wide else
                                    (1, g, self.rng.randint(1, g)))
            self.shape = (wide, width)
        wide, width = self.shape
        height = self.rng.choice((1, 2, 2 * g, self.rng.randint(1, 2 * g), self.rng.randint(1, 5)))
        self.bank = 1 - self.bank
        rows = []
        for row in range(height):
            words = [self.rng.getrandbits(g) for _ in range(1 + wide)]
            rows.append(_bits(words, g)[:width])
            for k, word in enumerate(words):
                self.writes.append({"wr_tpl_i": 1, "wr_wide_i": int(wide), "wr_bank_i": self.bank, "wr_row_i": row,
                                    "wr_word_i": k, "wr_data_i": word})
        return np.stack(rows), wide, self.bank
