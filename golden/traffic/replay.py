# SPDX-License-Identifier: Apache-2.0
"""The scores of the array from the operand writes and the steps alone, replayed on plain memories.

Checks the contract of the schedule (rtl/array/slog_array_pkg.sv): a word is not overwritten while it may still be
read, passes end far enough apart, the mask changes only in a drained array.
"""

from __future__ import annotations

from collections import deque

from golden.cycle.array.timing import REUSE_CLOCKS, drain_clocks
from golden.params import Config


class Replay:
    """Plain operand memories behind `slog_fetch` and `slog_sequencer`.

    `mismatches` has a list per pass: the Hamming distances of its offsets from left to right.
    """

    def __init__(self, config: Config) -> None:
        self.config = config
        self.words: dict[tuple[int, int, int, int], int] = {}  # (template?, bank, row, word) -> bits
        self.recent: deque[tuple[int, frozenset[tuple[int, int, int, int]]]] = deque()
        self.mismatches: list[list[int]] = []
        self.running: list[int] = []
        self.clock = self.steps = 0
        self.last_end: int | None = None
        self.last_lanes = 0
        self.last_step = -1000
        self.mask: int | None = None

    def step(self, write: dict[str, int] | None, step: dict[str, int] | None, mask: int | None) -> None:
        """One clock: an operand write (tpl, wide, bank, row, word, data) and a step (`step_t`), either may be None.

        Raises:
            AssertionError: if the schedule breaks its contract.
        """
        c = self.config
        if mask != self.mask:
            assert self.clock - self.last_step > drain_clocks(c.group_bits, c.lanes), "mask changed too early"
            self.mask = mask
        while self.recent and self.recent[0][0] <= self.clock - REUSE_CLOCKS:
            self.recent.popleft()
        if step is not None:
            self._pass(step)
        if write is not None:
            key = (write["tpl"], write["bank"] if write["tpl"] else 0, write["row"], write["word"])
            assert all(key not in read for _, read in self.recent), f"{key} overwritten while it may still be read"
            self.words[key] = write["data"]
        self.clock += 1

    def _pass(self, step: dict[str, int]) -> None:
        c = self.config
        assert self.mask is not None, "step without a mask"
        used: set[tuple[int, int, int, int]] = set()

        def bits(tpl: int, row: int, first: int, count: int) -> int:
            """`count` bits of an operand row from bit `first`; words never written count as zero."""
            word, shift = divmod(first, c.group_bits)
            value = 0
            for k in range(-(-(shift + count) // c.group_bits)):
                key = (tpl, step["bank"] if tpl else 0, row, word + k)
                used.add(key)
                value |= self.words.get(key, 0) << k * c.group_bits
            return value >> shift & (1 << count) - 1

        g, s, ring = c.group_bits, step["tpl_step"], c.ring_rows
        # Per group: template row, first bit in it, search row, first bit in the mask.
        if step["wide"]:
            groups = [(s, 0, step["ring_row"], 0), (s, g, step["ring_row"], g)]
        else:
            groups = [(2 * s, 0, step["ring_row"], 0), (2 * s + 1, 0, (step["ring_row"] + 1) % ring, g)]
        if not step["row_b"]:
            groups.pop()
        if step["first"]:
            assert not self.running, "a pass begins within another"
            self.running = [0] * step["lanes"]
        assert len(self.running) == step["lanes"], "lanes change within a pass"
        for tpl_row, tpl_bit, ring_row, mask_bit in groups:
            mask = self.mask >> mask_bit & (1 << g) - 1
            template = bits(1, tpl_row, tpl_bit, g)
            search = bits(0, ring_row, step["chunk"] * c.pitch + tpl_bit, g + step["lanes"] - 1)
            for lane in range(step["lanes"]):
                self.running[lane] += ((template ^ search >> lane) & mask).bit_count()
        self.recent.append((self.clock, frozenset(used)))
        self.steps += 1
        self.last_step = self.clock
        if step["last"]:
            if self.last_end is not None:
                assert self.clock - self.last_end >= self.last_lanes, "passes end too close together"
            self.last_end, self.last_lanes = self.clock, step["lanes"]
            self.mismatches.append(self.running)
            self.running = []
