# SPDX-License-Identifier: Apache-2.0
"""What every report begins with."""

from __future__ import annotations

import html
import re
from pathlib import Path

from signum.common.version import VERSION


def check_head(page: Path, command: str, source: str, board: bool = True) -> None:
    """A report begins with source, options, version, date, frames, speed of the host, clocks of the board and what was
    refused, in this order, under the usual title.

    Args:
        page: the report.
        command: whose run it tells of.
        source: of the frames, as the head names it.
        board: whether a board was at work.
    """
    text = page.read_text()
    assert re.search(r"<title>Signum: [^<]+</title>", text)
    first = text[text.index("<table>"):text.index("</table>")]
    rows = [(html.unescape(a), html.unescape(b)) for a, b in re.findall("<tr><td>([^<]*)</td><td>([^<]*)</td>", first)]
    names, values = [a for a, _ in rows], dict(rows)
    assert names[:5] == ["source", "command and options", "version, date", "frames", "host, frames/s"]
    assert values["source"] == source and values["command and options"].startswith(f"signum {command} --")
    assert re.fullmatch(re.escape(VERSION) + r", \d{4}-\d\d-\d\d \d\d:\d\d[+-]\d\d:\d\d", values["version, date"])
    assert int(values["frames"].replace(",", "")) > 0 and float(values["host, frames/s"]) > 0
    clocks = [values[name] for name in names if "clocks a frame" in name]
    assert len(clocks) == board and all(int(count.replace(",", "")) > 0 for count in clocks)
    refused = [name for name in names if name.startswith("refused")]
    assert refused and all(values[name] == "none" if name == "refused" else int(values[name].replace(",", "")) > 0
                           for name in refused)
