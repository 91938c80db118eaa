# SPDX-License-Identifier: Apache-2.0
"""Writes a module that holds many mutants: the package's `id` chooses one while the simulator runs, 0 chooses none."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sim.mutate.sites import Mutant

PACKAGE = Path(__file__).with_name("slog_mutant_pkg.sv")
CHOSEN = "slog_mutant_pkg::id"


def mutated(source: bytes, mutants: Sequence[Mutant]) -> str:
    """The source with all `mutants` in it.

    Args:
        source: of the module.
        mutants: of this source; the first gets the number 1.

    Returns:
        A source of as many lines.
    """
    numbers = {mutant.name: n for n, mutant in enumerate(mutants, 1)}
    spans = sorted({(m.start, m.end) for m in mutants}, key=lambda span: (span[0], -span[1]))
    by_span = {span: [m for m in mutants if (m.start, m.end) == span] for span in spans}

    def render(start: int, end: int, inner: list[tuple[int, int]]) -> str:
        out, at = [], start
        while inner:
            span = inner[0]
            within = [s for s in inner[1:] if s[1] <= span[1]]
            out += [source[at:span[0]].decode(), wrapped(span, within)]
            inner, at = inner[1 + len(within):], span[1]
        return "".join(out) + source[at:end].decode()

    def wrapped(span: tuple[int, int], within: list[tuple[int, int]]) -> str:
        text = render(*span, within)
        here = by_span[span]
        dropped = [f"{CHOSEN} != {numbers[m.name]}" for m in here if m.statement]
        if dropped:
            return f"begin if ({' && '.join(dropped)}) {text} end"
        choices = "".join(f"{CHOSEN} == {numbers[m.name]} ? ({' '.join(m.changed.split())}) : " for m in here)
        return f"({choices}({text}))"

    return render(0, len(source), spans)


def only(source: bytes, mutant: Mutant) -> str:
    """The source with one mutant in place of what it changes."""
    return source[:mutant.start].decode() + (f"({mutant.changed})" if mutant.changed else ";") \
        + source[mutant.end:].decode()
