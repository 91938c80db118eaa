# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_filter_bank`."""

from __future__ import annotations

from collections import deque

from golden.params import COEF_BITS, Config

SETTLE = 12
"""Clocks without an active camera before a commit takes effect."""

class FilterBankModel:
    """Coefficients as lists, centre first; the active ones are undefined until they are shifted in."""

    def __init__(self, config: Config) -> None:
        self.config = config
        self.active: dict[int, list[int | None]] = {kernel: [None] * config.coefs for kernel in (0, 1)}
        self.load: int | None = None  # clocks since shifting began
        self.reset()

    def reset(self) -> None:
        """State after reset: zeros are being shifted in. A shift in the clock of the reset is still done."""
        self._shift()
        zeros = [0] * self.config.coefs
        self.staged = {0: list(zeros), 1: list(zeros)}
        self.settle, self.pending, self.error, self.changed = 0, 0, 0, 0
        self.camera = False  # a camera was active in the clock before
        # Coefficients to be staged: kernel, index, value.
        self.coming: deque[tuple[int, int, int] | None] = deque([None] * 5, 5)
        self.hold = [1] * self.config.cameras
        self.taking: tuple[int, int] | None = None  # size that takes effect in this clock
        self.load = 1
        self.clearing = True
        self.read = self.next = {0: 0, 1: 0}  # inputs of the first coefficients in the next clock and in this one
        self.size = (self.config.max_width, self.config.max_height)

    @property
    def busy(self) -> int:
        """1 while a commit is pending or coefficients are shifted in."""
        return int(self.pending or self.taking is not None or self.load is not None)

    def coefs(self, second: int) -> int | None:
        """The packed active coefficients of g (0) or g2 (1); None if undefined."""
        values = [v for v in self.active[second] if v is not None]
        whole = len(values) == self.config.coefs
        return sum(v << COEF_BITS * k for k, v in enumerate(values)) if whole else None

    def _shift(self) -> None:
        """Shift p reaches coefficient k of g in clock 4 + 2 * p + coefs - 1 - k of the load, of g2 one clock later.

        The load ends two clocks after the last shift.
        """
        if self.load is None:
            return
        count = self.config.coefs
        shifted = [count + 3 + 2 * p - self.load for p in range(count)]
        for kernel, values in self.active.items():
            before = [self.next[kernel], *values[:-1]]
            for k in (at + kernel for at in shifted):
                if 0 <= k < count:
                    values[k] = before[k]
        place = count - 1 - sum(k <= 0 for k in shifted)  # coefficient of the next shift
        self.next = self.read
        if place >= 0:
            self.read = {kernel: 0 if self.clearing else self.staged[kernel][place] for kernel in (0, 1)}
        self.load += 1
        if self.load == 3 * count + 5:
            self.load, self.clearing = None, False

    def edge(self, *, coef: bool, second: int, index: int, value: int, commit: bool, size: tuple[int, int],
             active: int) -> None:
        """Take the clock edge."""
        c = self.config
        self.hold = [self.busy, *self.hold[:-1]]
        calm = bool(self.pending and not self.camera and self.taking is None and self.load is None)
        apply = calm and self.settle == SETTLE
        self.changed = 0
        self._shift()
        if self.taking is not None:
            good = c.min_image <= self.taking[0] <= c.max_width and c.min_image <= self.taking[1] <= c.max_height
            self.error = int(not good)
            if good:
                self.changed, self.size = int(self.taking != self.size), self.taking
            self.load = 1
        self.taking = size if apply else None
        self.coming.append((second, index, value) if coef and index < c.coefs else None)
        for kernel in (0, 1):
            came = self.coming[1 - kernel]
            if came is not None and came[0] == kernel:
                self.staged[kernel][came[1]] = came[2]
        self.settle = min(self.settle + 1, SETTLE) if calm else 0
        self.pending = int(commit or (self.pending and not apply))
        self.camera = bool(active)
