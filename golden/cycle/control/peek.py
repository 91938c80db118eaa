# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_peek`."""

from __future__ import annotations


class PeekModel:
    """Reads words of the store in order, a 32-bit part at a time."""

    def __init__(self, group_bits: int, store_words: int) -> None:
        self.store_words, self.chunks = store_words, -(-group_bits // 32)
        self.reset()

    def reset(self) -> None:
        """State after reset."""
        self.go = self.started = self.onward = self.new = self.new2 = self.want = self.flight = self.drop = False
        self.valid = self.outside = self.done = False
        self.have = True
        self.word: int | None = 0
        self.coming: int | None = None  # peek_data_i of the clock before
        self.chunk, self.address = 0, 0

    @property
    def data(self) -> int | None:
        """The part that the next read returns; None if undefined."""
        return None if self.word is None else self.word >> 32 * self.chunk & 0xFFFFFFFF

    @property
    def ready(self) -> bool:
        """`data` is valid."""
        return self.have and not self.go

    def edge(self, *, go: int, address: int, take: bool, ready: int, done: int, data: int | None) -> None:
        """Take the clock edge."""
        now, self.go = self.go, bool(go)
        taken = self.valid and bool(ready)
        ask = self.want and not self.flight and not self.valid
        inside = self.address < self.store_words
        onward, self.onward = self.onward, take and self.started and self.chunk == self.chunks - 1
        self.want = self.new2 or (self.want and not ask)
        self.new, self.new2 = now or onward, self.new
        if self.outside:
            self.have, self.word = True, 0
        self.outside = not now and ask and not inside
        self.valid = not now and ((ask and inside) or (self.valid and not ready))
        if self.done:
            self.have, self.word = not self.drop, self.coming
        drop = (self.flight and not self.done) or taken
        if self.done:
            self.drop = False
        self.flight = taken or (self.flight and not self.done)
        self.done, self.coming = bool(done), data
        self.chunk += take
        if onward:
            self.have, self.address, self.chunk = False, (self.address + 1) & 0xFFFFFF, 0
        if now:
            self.started, self.want, self.have, self.address, self.chunk = True, False, False, address, 0
            self.drop = drop
