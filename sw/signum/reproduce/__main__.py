# SPDX-License-Identifier: Apache-2.0
"""`python -m signum.reproduce`: the page, section by section; status 1 where a bar is missed or a section failed."""

from __future__ import annotations

import argparse
import sys
import time
import traceback
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from signum.boards import BOARDS, open_board
from signum.common.console import notes, out, progress
from signum.report.page import Section, paragraph, table, write_page
from signum.reproduce import Maker
from signum.reproduce.makers import MAKERS
from signum.tables.schemas import BARS
from signum.tables.table import Table


class Page:
    """The page and `bars.csv`, complete after every section."""

    def __init__(self, path: Path, title: str, about: str) -> None:
        self.path, self.title, self.about = path, title, about
        self.sections: list[Section] = []
        self.failed: list[str] = []
        self._began = time.monotonic()
        path.parent.mkdir(parents=True, exist_ok=True)

    def add(self, name: str, sections: Sequence[Section]) -> None:
        """Add the sections of a maker, print their bars, write the page."""
        self.sections += sections
        for section in sections:
            for bar in section.bars:
                out.print(f"{name}: {bar}", markup=False)
        self.write()

    def fail(self, name: str, error: Exception) -> None:
        """Note that a maker failed, and write the page."""
        self.failed.append(name)
        notes.print(f"{name}: failed\n{''.join(traceback.format_exception(error))}", markup=False)
        self.sections.append(Section(f"{name}: failed", paragraph(f"{type(error).__name__}: {error}")))
        self.write()

    @property
    def missed(self) -> int:
        """Bars missed so far."""
        return sum(not bar.met for section in self.sections for bar in section.bars)

    def write(self) -> None:
        """Write the page and the bars."""
        bars = [(section.title, bar) for section in self.sections for bar in section.bars]
        summary = table(("", ""), [
            ("bars met", f"{len(bars) - self.missed} of {len(bars)}"), ("sections that failed", str(len(self.failed))),
            ("duration of this run", f"{(time.monotonic() - self._began) / 60:.1f} min")])
        write_page(self.path, self.title, self.sections, paragraph(self.about) + summary)
        rows = Table(self.path.parent / "bars.csv", BARS)
        for title, bar in bars:
            rows.write([title, bar.what, f"{bar.measured:.6g}", bar.relation, f"{bar.bound:g}", int(bar.met)])
        rows.close()


def make_page(chosen: dict[str, Maker], board: str, folder: Path, seed: int, quick: bool) -> Page:
    """Make the page.

    Args:
        chosen: makers by name, in order.
        board: one of BOARDS.
        folder: for `index.html`, `bars.csv` and a folder per maker.
        seed: of all random numbers.
        quick: a short version.
    """
    kind = "the golden model" if board == "golden" else "the Verilated RTL"
    about = (f"Every sign bit and every score came out of {kind}; seed {seed}"
             + ("; a short version: bars are judged on less data than at full length." if quick else "."))
    page = Page(folder / "index.html", "Signum: the paper's figures and tables", about)
    page.write()
    for name, make in chosen.items():
        place = folder / name
        place.mkdir(exist_ok=True)
        try:
            page.add(name, make(partial(open_board, board), place, seed, quick, progress))
        except Exception as error:  # the other sections are still made; the exit status is 1
            page.fail(name, error)
    return page


def main(argv: Sequence[str] | None = None) -> int:
    """Make the page; returns the exit status: 0, 1 where a bar is missed or a section failed, 130 when stopped."""
    known = MAKERS
    parser = argparse.ArgumentParser(prog="python -m signum.reproduce", description="The paper's figures and tables.")
    parser.add_argument("--board", choices=BOARDS, default="golden")
    parser.add_argument("--out", type=Path, default=Path("out/reproduce"), help="folder; made if missing")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--quick", action="store_true", help="a short version of a few minutes")
    parser.add_argument("--only", action="append", choices=tuple(known), metavar="NAME",
                        help=f"make only this section; may be repeated; one of {', '.join(known)}")
    options = parser.parse_args(argv)
    chosen = {name: make for name, make in known.items() if name in (options.only or known)}
    out.print(f"board {options.board}, seed {options.seed}{', quick' if options.quick else ''}")
    try:
        page = make_page(chosen, options.board, options.out, options.seed, options.quick)
    except KeyboardInterrupt:
        notes.print("stopped; the page holds what was finished")
        return 130
    total = sum(len(s.bars) for s in page.sections)
    out.print(f"{page.path}: {total - page.missed} of {total} bars met"
              + (f"; failed: {', '.join(page.failed)}" if page.failed else ""), markup=False)
    return int(bool(page.missed or page.failed))


if __name__ == "__main__":
    sys.exit(main())
