# SPDX-License-Identifier: Apache-2.0
"""Functional coverage that every test bench counts by itself: how each handshake of the module was stalled."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from golden.cycle.model import Inputs
from sim.coverage.functional import FEW, MANY, STALLS


class Stalls:
    """Counts STALLS for each pair of valid and ready among the names of a module's ports.

    Attributes:
        counts: by "interface: stall"; the interface is the name of its valid.
    """

    def __init__(self, names: Iterable[str]) -> None:
        names = set(names)
        pairs = ((name, _partner(name)) for name in sorted(names) if "valid" in name)
        self.pairs = [(valid, ready) for valid, ready in pairs if ready in names]
        self.counts = Counter({f"{valid}: {shape}": 0 for valid, _ in self.pairs for shape in STALLS})
        self._waited: Counter[tuple[str, int]] = Counter()
        self._moved: set[tuple[str, int]] = set()

    def observe(self, i: Inputs, out: Mapping[str, int | None]) -> None:
        """Take a clock: the inputs, and the outputs, None where undefined; the bits of a port are handshakes of their
        own."""
        if i.get("rst_i"):
            self._waited.clear()
            self._moved.clear()
            return
        moved = set()
        for valid, ready in self.pairs:
            offers, takes = (i[name] if name in i else out.get(name) or 0 for name in (valid, ready))
            for bit in range(max(offers | takes, 1).bit_length()):
                key, offered, taken = (valid, bit), offers >> bit & 1, takes >> bit & 1
                if not offered:  # nothing waits, or what waited was withdrawn
                    self._waited.pop(key, None)
                    self.counts[f"{valid}: {STALLS[5]}"] += taken
                elif taken:
                    waited = self._waited.pop(key, 0)
                    self.counts[f"{valid}: {STALLS[(waited > 0) + (waited >= FEW) + (waited >= MANY)]}"] += 1
                    self.counts[f"{valid}: {STALLS[4]}"] += key in self._moved
                    moved.add(key)
                else:
                    self._waited[key] += 1
        self._moved = moved


def _partner(valid: str) -> str:
    """The ready that belongs to a valid: the direction in its name, if there is one, is the other."""
    name = valid.replace("valid", "ready")
    return name[:-1] + {"i": "o", "o": "i"}[name[-1]] if name.endswith(("_i", "_o")) else name
