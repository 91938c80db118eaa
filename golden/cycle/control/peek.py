"""Cycle model of `slog_peek`."""

from __future__ import annotations


class PeekModel:
    """`slog_peek`."""

    def __init__(self, group_bits: int, store_words: int) -> None:
        self.store_words, self.chunks = store_words, -(-group_bits // 32)
        self.reset()

    def reset(self) -> None:
        """State after reset."""
        self.go = self.started = self.onward = self.new = self.new2 = self.want = self.flight = self.drop = False
        self.valid = self.outside = self.done = False
        self.have = True
        self.word: int | None = 0
        self.coming: int | None = None  # what the store showed in the clock before
        self.chunk, self.address = 0, 0

    @property
    def data(self) -> int | None:
        """What the next read gets; None if undefined."""
        return None if self.word is None else self.word >> 32 * self.chunk & 0xFFFFFFFF

    @property
    def ready(self) -> bool:
        """`data` may be read."""
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
