# SPDX-License-Identifier: Apache-2.0
"""What a run was: source, options, version, date, frames, speed, refusals; the head of every report.

The page itself keeps it, as the only file that has dates and speeds: a report made anew begins as the one before it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

from signum.common.console import notes
from signum.common.files import own_bytes
from signum.report.page import table

MARK = '<script type="application/json" id="runs">'
"""Before the runs in a page; JSON follows, which has no `<`."""
WORDS = {
    "outside": "the window, or all it was searched for in, lies outside the picture", "score": "the match is too poor",
    "margin": "another place matches nearly as well", "border": "the match lies at the border of the search",
    "texture": "too little texture", "return": "the search back does not return",
    "parts": "parts of the window, or one twice as large, moved differently", "support": "no window beside agrees",
    "patch": "a patch of like disparities that is smaller than a window",
    "anchor": "not where the feature's first picture puts it", "neighbours": "not as the features around it move",
    "drift": "measured only against later pictures, too inexactly"}
"""What a measurement's reason of refusal means."""


@dataclass(frozen=True)
class About:
    """A command's run.

    Attributes:
        command: its name. version: of signum. source: of the frames, empty for a simulated world.
        options: as the command line takes them, those that were not given with their defaults.
        date: when the report was written, local, to the minute, ISO 8601.
        frames: finished. seconds: that the host took for them, its waiting for a live source included.
        board: its name, empty where none was used. clocks: that it took for all frames; estimated: whether these are
            not counted by RTL.
        refused: measurements, or frames, that were refused, by the reason.
        result: the size of what was made, in words; empty for tables alone.
    """

    command: str
    version: str
    source: str
    options: str
    date: str
    frames: int
    seconds: float
    board: str
    clocks: int
    estimated: bool
    refused: Mapping[str, int] = field(default_factory=dict)
    result: str = ""

    @property
    def rows(self) -> list[tuple[str, str]]:
        """The table at the head of a report: what, and its value."""
        speed = f"{self.frames / self.seconds:.1f}" if self.seconds > 0 else "not measured"
        lines = [("source", self.source or "simulated world"),
                 ("command and options", f"signum {self.command} {self.options}".strip()),
                 ("version, date", f"{self.version}, {self.date}"), ("frames", f"{self.frames:,}"),
                 ("host, frames/s", speed)]
        if self.frames and self.board:
            lines.append((f"board {self.board}, clocks a frame{', estimated' if self.estimated else ''}",
                          f"{self.clocks / self.frames:,.0f}"))
        refused = {reason: count for reason, count in self.refused.items() if count}
        lines += [(f"refused: {WORDS.get(reason, reason)}", f"{count:,}") for reason, count in refused.items()]
        lines += [] if refused else [("refused", "none")]
        return lines + ([("result", self.result)] if self.result else [])


def head(page: Path, *runs: About) -> str:
    """HTML for the head of a page: the runs given, and those of other commands that the page has now, if it exists."""
    kept = {run.command: run for run in (*_read(page), *runs)}
    data = json.dumps([asdict(run) for run in kept.values()]).replace("<", "\\u003c")
    shown = "".join(table(("run", ""), run.rows) for run in kept.values())
    return f"<div class='run'>{shown}</div>{MARK}{data}</script>" if kept else ""


def _read(page: Path) -> list[About]:
    """The runs of a page; none where it does not exist or, which a note says, they cannot be read."""
    try:
        found = re.search(re.escape(MARK) + "([^<]*)<", own_bytes(page).decode("utf-8", "replace"))
        runs = [About(**values) for values in json.loads(found[1])] if found else []
        for run in runs:
            assert all(isinstance(text, str) for row in run.rows for text in row)
    except FileNotFoundError:
        return []
    except (OSError, ValueError, TypeError, AttributeError, AssertionError, OverflowError, RecursionError) as error:
        notes.print(f"{page}: what it says of its run cannot be read ({type(error).__name__}) and is left out")
        return []
    return runs
