# SPDX-License-Identifier: Apache-2.0
"""Self-contained pages: one HTML file with its pictures, plots and tables inside."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import matplotlib
from matplotlib.figure import Figure

from signum.common.arrays import Image
from signum.common.files import png, write_text

matplotlib.use("Agg")

STYLE = """
body{font:16px/1.5 system-ui,sans-serif;max-width:1060px;margin:2em auto;padding:0 1em;color:#1c2733;background:#fbfcfd}
h1{margin-bottom:0}h2{margin-top:2em;border-bottom:1px solid #ccd6df}figure{margin:0}
figcaption{font-size:.85em;color:#51606d;text-align:center}
.row{display:flex;flex-wrap:wrap;gap:12px;align-items:flex-start;margin:1em 0}.row figure{flex:1 1 220px}
.row figure:nth-child(n+5){max-width:calc(50% - 6px)}
video,img{width:100%;height:auto;display:block;image-rendering:auto}table{border-collapse:collapse;margin:1em 0}
td,th{padding:.25em .9em;border-bottom:1px solid #dde5ec;text-align:right}
td:first-child,th:first-child{text-align:left}.met{color:#1a7f37}.missed{color:#b42318;font-weight:600}
.tall{max-width:360px}.run td{text-align:left}
"""


@dataclass(frozen=True)
class Bar:
    """A measured figure and the bound it has to keep.

    Attributes:
        what: the figure, with its unit.
        measured: its value.
        relation, bound: it is met if `measured relation bound`.
    """

    what: str
    measured: float
    relation: Literal["<=", ">="]
    bound: float

    @property
    def met(self) -> bool:
        """Whether the bar is met; NaN meets none."""
        return self.measured <= self.bound if self.relation == "<=" else self.measured >= self.bound

    def __str__(self) -> str:
        return f"{self.what}: {self.measured:.4g} ({self.relation} {self.bound:g}){'' if self.met else ' MISSED'}"


@dataclass(frozen=True)
class Section:
    """A part of a page: a heading, HTML made with the functions below, and bars for its figures."""

    title: str
    body: str
    bars: tuple[Bar, ...] = ()

    @property
    def html(self) -> str:
        """The section, its bars as a table at the end."""
        bars = "".join(
            f"<tr><td>{html.escape(b.what)}</td><td class={'met' if b.met else 'missed'}>{b.measured:.4g}</td>"
            f"<td>{html.escape(b.relation)} {b.bound:g}</td></tr>" for b in self.bars)
        table = f"<table><tr><th>figure</th><th>measured</th><th>bound</th></tr>{bars}</table>" if bars else ""
        return f"<h2>{html.escape(self.title)}</h2>{self.body}{table}"


def write_page(path: Path, title: str, sections: Sequence[Section], head: str = "") -> Path:
    """Write a self-contained page.

    Args:
        path: the file; its folder exists.
        title: plain text.
        sections: in order.
        head: HTML between the title and the first section.
    """
    body = head + "".join(section.html for section in sections)
    write_text(path, f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
                    f"<style>{STYLE}</style></head><body><h1>{html.escape(title)}</h1>{body}</body></html>\n")
    return path


def paragraph(text: str) -> str:
    """Plain text as a paragraph."""
    return f"<p>{html.escape(text)}</p>"


def figure(picture: Image, caption: str) -> str:
    """A picture (uint8, grey or BGR) with its caption."""
    data = png(picture)
    return _image(data, caption)


def plot(drawn: Figure, caption: str) -> str:
    """A plot with its caption; the plot is closed."""
    from matplotlib import pyplot as plt

    buffer = io.BytesIO()
    drawn.tight_layout()
    drawn.savefig(buffer, format="png", dpi=110)
    plt.close(drawn)
    return _image(buffer.getvalue(), caption)


def row(figures: Sequence[str]) -> str:
    """Figures side by side."""
    return f"<div class='row'>{''.join(figures)}</div>"


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of plain text."""
    head = "".join(f"<th>{html.escape(h)}</th>" for h in heads)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in line) + "</tr>" for line in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _image(png: bytes, caption: str) -> str:
    text = html.escape(caption)
    return (f'<figure><img alt="{text}" src="data:image/png;base64,{base64.b64encode(png).decode()}">'
            f"<figcaption>{text}</figcaption></figure>")
