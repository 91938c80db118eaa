# SPDX-License-Identifier: Apache-2.0
"""Draws the block diagrams of the documentation: `python docs/tools/diagrams.py` writes `docs/img/*.svg`.

A diagram is boxes on a grid of columns and rows, and arrows between them. An arrow runs along a row, along a column,
or first along the row of its start and then along the column of its end.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape
from pathlib import Path

IMAGES = Path(__file__).resolve().parents[1] / "img"
PITCH_X, PITCH_Y, BOX_W, BOX_H, MARGIN = 196, 108, 138, 62, 14
TEXT = 'font-family="Roboto, Helvetica, Arial, sans-serif"'
FILL = {"block": "#e0f2f1", "memory": "#fff3e0", "outside": "#ffffff"}
Place = tuple[float, float]
"""Column and row of a box."""


@dataclass
class Diagram:
    """Boxes and arrows of one picture."""

    title: str
    boxes: dict[str, tuple[Place, str, str]] = field(default_factory=dict)
    arrows: list[tuple[str, str, str, bool]] = field(default_factory=list)

    def box(self, name: str, col: float, row: float, text: str, kind: str = "block") -> None:
        """A box; lines of its text are separated by |, the first is its heading."""
        self.boxes[name] = ((col, row), text, kind)

    def arrow(self, start: str, end: str, label: str = "", thin: bool = False) -> None:
        """An arrow with a label; thin for settings and status."""
        self.arrows.append((start, end, label, thin))

    def svg(self) -> str:
        """The picture."""
        cols = max(p[0] for p, _, _ in self.boxes.values())
        rows = max(p[1] for p, _, _ in self.boxes.values())
        width = round(cols * PITCH_X + BOX_W + 2 * MARGIN)
        height = round(rows * PITCH_Y + BOX_H + 2 * MARGIN)
        parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
                 f'height="{height}" role="img" '
                 f'aria-label="{escape(self.title)}">', f"<title>{escape(self.title)}</title>",
                 '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
                 'orient="auto"><path d="M0 0L8 4L0 8z" fill="#37474f"/></marker></defs>',
                 f'<rect width="{width}" height="{height}" rx="6" fill="#fafafa"/>']
        parts += [self._arrow(*arrow) for arrow in self.arrows]
        parts += [_box(*box) for box in self.boxes.values()]
        return "\n".join([*parts, "</svg>", ""])

    def _arrow(self, start: str, end: str, label: str, thin: bool) -> str:
        (c0, r0), (c1, r1) = self.boxes[start][0], self.boxes[end][0]
        x0, y0, x1, y1 = *_centre(c0, r0), *_centre(c1, r1)
        right, down = (1 if x1 > x0 else -1), (1 if y1 > y0 else -1)
        if abs(y0 - y1) < 1:
            points = [(x0 + right * BOX_W / 2, y0), (x1 - right * (BOX_W / 2 + 1), y1)]
            at, anchor = ((points[0][0] + points[1][0]) / 2, y0 - 6), "middle"
        elif abs(x0 - x1) < 1:
            points = [(x0, y0 + down * BOX_H / 2), (x1, y1 - down * (BOX_H / 2 + 1))]
            at, anchor = (x0 + 6, (points[0][1] + points[1][1]) / 2 + 4), "start"
        else:
            points = [(x0 + right * BOX_W / 2, y0), (x1, y0), (x1, y1 - down * (BOX_H / 2 + 1))]
            at, anchor = (x1 + 6, (y0 + points[2][1]) / 2 + 4), "start"
        path = "M" + " L".join(f"{x:g} {y:g}" for x, y in points)
        dash = ' stroke-dasharray="4 3"' if thin else ""
        lines = "".join(f'<tspan x="{at[0]:g}" dy="{0 if k == 0 else 13}">{escape(line)}</tspan>'
                        for k, line in enumerate(label.split("|")))
        return (f'<path d="{path}" fill="none" stroke="#37474f" stroke-width="{1 if thin else 1.6}"{dash} '
                f'marker-end="url(#tip)"/>'
                f'<text x="{at[0]:g}" y="{at[1]:g}" {TEXT} font-size="11.5" fill="#37474f" '
                f'text-anchor="{anchor}">{lines}</text>')


def _centre(col: float, row: float) -> Place:
    return MARGIN + col * PITCH_X + BOX_W / 2, MARGIN + row * PITCH_Y + BOX_H / 2


def _box(place: Place, text: str, kind: str) -> str:
    x, y = _centre(*place)
    lines = text.split("|")
    out = [f'<rect x="{x - BOX_W / 2:g}" y="{y - BOX_H / 2:g}" width="{BOX_W}" height="{BOX_H}" rx="4" '
           f'fill="{FILL[kind]}" stroke="#00796b" stroke-width="1.3"/>']
    for k, line in enumerate(lines):
        style = 'font-size="13.5" font-weight="600"' if k == 0 else 'font-size="11.5"'
        at = y + 4 + 15 * (k - (len(lines) - 1) / 2)
        out.append(f'<text x="{x:g}" y="{at:g}" {TEXT} {style} fill="#102027" text-anchor="middle">'
                   f'{escape(line)}</text>')
    return "".join(out)


def board() -> Diagram:
    """The board with its rooms."""
    d = Diagram("The board: cameras, front ends, store, correlator, array, peak unit, control")
    d.box("cam0", 0, 0, "Camera 0|AXI4-Stream video", "outside")
    d.box("cam1", 0, 1, "Camera 1|AXI4-Stream video", "outside")
    d.box("f0", 1, 0, "Front end|sign of LoG")
    d.box("f1", 1, 1, "Front end|sign of LoG")
    d.box("store", 2, 1, "Store|captures, 6 slots|of sign bits", "memory")
    d.box("corr", 3, 1, "Correlator|jobs to operands|and steps")
    d.box("array", 4, 1, "Array|33 lanes,|128 bits each")
    d.box("peak", 4, 2, "Peak|best, neighbours,|runner-up")
    d.box("control", 3, 2, "Control|registers, counters,|interrupt")
    d.box("host", 0, 3, "Host|AXI4-Lite", "outside")
    d.box("surface", 4, 3, "Surface|AXI4-Stream", "outside")
    d.arrow("cam0", "f0", "pixels")
    d.arrow("cam1", "f1", "pixels")
    d.arrow("f0", "store", "sign words")
    d.arrow("f1", "store", "words")
    d.arrow("store", "corr", "rows")
    d.arrow("corr", "array", "steps")
    d.arrow("array", "peak", "mismatches")
    d.arrow("peak", "control", "results")
    d.arrow("host", "control", "accesses")
    d.arrow("control", "corr", "jobs")
    d.arrow("control", "store", "captures,|peeks", thin=True)
    d.arrow("peak", "surface", "on request")
    return d


def frontend() -> Diagram:
    """One camera's front end."""
    d = Diagram("Front end: video input, line buffer, vertical and horizontal filters, sign, packer")
    d.box("cam", 0, 0, "Camera|8-bit pixels", "outside")
    d.box("video", 1, 0, "slog_video_in|whole lines only,|bad frames dropped")
    d.box("buffer", 2, 0, "slog_line_buffer|2 Radius lines,|border repeated", "memory")
    d.box("vert", 3, 0, "slog_fir, vertical|g * p, g2 * p|(two kernels)")
    d.box("taps", 3, 1, "slog_taps|windows along|the line")
    d.box("horiz", 2, 1, "slog_fir, horizontal|g2 * v + g * v2")
    d.box("sign", 1, 1, "> 0|sign bit")
    d.box("pack", 0, 1, "slog_packer|words of|sign bits")
    d.box("store", 0, 2, "Store", "outside")
    d.arrow("cam", "video", "tdata")
    d.arrow("video", "buffer", "lines")
    d.arrow("buffer", "vert", "column")
    d.arrow("vert", "taps", "v, v2: 17 bits")
    d.arrow("taps", "horiz", "windows")
    d.arrow("horiz", "sign", "36 bits")
    d.arrow("sign", "pack", "bit")
    d.arrow("pack", "store", "words, frame start, done, abort")
    return d


def store() -> Diagram:
    """Captures and bit planes."""
    d = Diagram("Store: capture channels, word queues, banks of block RAM, read and peek ports")
    d.box("f0", 0, 0, "Front end 0", "outside")
    d.box("f1", 0, 1, "Front end 1", "outside")
    d.box("c0", 1, 0, "capture channel|slot, address")
    d.box("c1", 1, 1, "capture channel|slot, address")
    d.box("queue", 2, 0.5, "capture slices|two word queues,|camera 0 first", "memory")
    d.box("store", 3, 0.5, "slog_store|slots of sign bits|in block RAM", "memory")
    d.box("corr", 4, 0.5, "Correlator", "outside")
    d.box("control", 1, 2, "Control", "outside")
    d.box("peek", 3, 2, "slog_peek|32 bits at a time", "outside")
    d.arrow("f0", "c0", "words")
    d.arrow("f1", "c1", "words")
    d.arrow("c0", "queue")
    d.arrow("c1", "queue")
    d.arrow("queue", "store", "one write")
    d.arrow("store", "corr", "one read")
    d.arrow("control", "c1", "arm, cancel, clear", thin=True)
    d.arrow("store", "peek", "low-priority read", thin=True)
    return d


def correlator() -> Diagram:
    """From jobs to steps of the array."""
    d = Diagram("Correlator: grid, fetch with check and plan, alignment, sequencer, walker")
    d.box("check", 3, 0, "job_check, job_plan|refuse the job, or place|it in the store")
    d.box("peak", 4, 0, "Peak", "outside")
    d.box("control", 0, 1, "Control", "outside")
    d.box("grid", 1, 1, "slog_grid|one command to|a grid of jobs")
    d.box("queue", 2, 1, "job queue|slog_ram_fifo", "memory")
    d.box("fetch", 3, 1, "slog_fetch|loads templates and|search rows ahead")
    d.box("seq", 4, 1, "slog_sequencer|rows of offsets")
    d.box("store", 2, 2, "Store", "outside")
    d.box("align", 3, 2, "slog_align|a row begins|at bit 0")
    d.box("walk", 4, 2, "slog_walker|passes and steps")
    d.box("array", 3, 3, "Array|operands and lanes", "outside")
    d.box("steps", 4, 3, "steps|rows of template and|search, unit, lanes", "outside")
    d.arrow("control", "grid", "command")
    d.arrow("grid", "queue", "jobs")
    d.arrow("queue", "fetch", "job")
    d.arrow("fetch", "check", "start")
    d.arrow("fetch", "seq", "ticket")
    d.arrow("seq", "peak", "context", thin=True)
    d.arrow("seq", "walk", "row")
    d.arrow("fetch", "align", "shift", thin=True)
    d.arrow("store", "align", "words")
    d.arrow("align", "array", "operands")
    d.arrow("walk", "steps")
    d.arrow("steps", "array")
    return d


def array() -> Diagram:
    """Operands and lanes."""
    d = Diagram("Array: operand memories, lanes, tree of adders, accumulators, emitter")
    d.box("fetch", 0, 0, "Fetch|search and template", "outside")
    d.box("walk", 0, 1, "Walker|steps", "outside")
    d.box("ring", 1, 0, "slog_search_ring|rows of the search,|unit by unit", "memory")
    d.box("tpl", 1, 1, "two templates|one loads while|one runs", "memory")
    d.box("lanes", 2, 0.5, "slog_lanes|search row slips one|bit per lane, XOR")
    d.box("pop", 3, 0.5, "slog_popcount|tree of registered|full adders")
    d.box("acc", 4, 0.5, "slog_accumulator|sum over the rows|of a pass")
    d.box("emit", 4, 1.7, "slog_emit|one lane's total|per clock")
    d.box("peak", 3, 1.7, "Peak", "outside")
    d.arrow("fetch", "ring", "words")
    d.arrow("walk", "tpl", "row")
    d.arrow("ring", "lanes")
    d.arrow("tpl", "lanes")
    d.arrow("lanes", "pop", "bits")
    d.arrow("pop", "acc", "count")
    d.arrow("acc", "emit", "totals, skewed")
    d.arrow("emit", "peak", "mismatch")
    return d


def peak() -> Diagram:
    """From mismatches to a result."""
    d = Diagram("Peak unit: intake, row banks, running maximum, best row, scan, collection, result queue")
    d.box("array", 0, 1, "Array", "outside")
    d.box("intake", 1, 1, "peak_intake|score = area -|mismatch")
    d.box("banks", 2, 1, "row banks|4 rows of scores", "memory")
    d.box("scan", 3, 1, "peak_scan|best's row, and those|above and below")
    d.box("collect", 4, 1, "peak_collect|neighbours,|runner-up")
    d.box("max", 2, 2, "running_max|a row's largest")
    d.box("best", 3, 2, "peak_best|best row so far,|orders its scan")
    d.box("queue", 4, 2, "result queue", "memory")
    d.box("rows", 1, 2, "peak_rows|contexts to rows")
    d.box("seq", 0, 2, "Sequencer", "outside")
    d.box("room", 0, 3, "peak_room|room for a|whole row")
    d.box("surface", 1, 0, "surface queue|AXI4-Stream", "memory")
    d.box("control", 4, 3, "Control", "outside")
    d.arrow("array", "intake", "mismatch")
    d.arrow("intake", "surface", "every score, on request")
    d.arrow("intake", "banks", "scores")
    d.arrow("banks", "scan", "columns")
    d.arrow("scan", "collect")
    d.arrow("banks", "max", "scores")
    d.arrow("max", "best", "maximum")
    d.arrow("best", "scan", "order", thin=True)
    d.arrow("collect", "queue", "verdict")
    d.arrow("queue", "control", "result")
    d.arrow("seq", "rows", "context")
    d.arrow("rows", "intake", "row", thin=True)
    d.arrow("room", "seq", "grant", thin=True)
    return d


def control() -> Diagram:
    """Registers and what they control."""
    d = Diagram("Control: AXI4-Lite, register block, filter bank, peek port, counters")
    d.box("host", 0, 0.5, "Host|AXI4-Lite", "outside")
    d.box("axil", 1, 0.5, "slog_axil|one access at a time,|all registered")
    d.box("csr", 2, 0.5, "slog_csr|generated from|slog_csr.rdl")
    d.box("bank", 3, 0, "slog_filter_bank|staged, changed|between frames", "memory")
    d.box("count", 3, 1, "slog_counters|32 bits each")
    d.box("peek", 2, 1.7, "slog_peek|reads planes back")
    d.box("front", 4, 0, "Front ends|coefficients, size", "outside")
    d.box("events", 4, 1, "Blocks|events, status", "outside")
    d.box("store", 1, 1.7, "Store", "outside")
    d.arrow("host", "axil", "access")
    d.arrow("axil", "csr", "request")
    d.arrow("csr", "bank", "")
    d.arrow("csr", "count", "")
    d.arrow("bank", "front", "hold")
    d.arrow("events", "count", "events")
    d.arrow("csr", "peek", "address")
    d.arrow("peek", "store", "read")
    return d


def cells() -> Diagram:
    """The small parts that all rooms use."""
    d = Diagram("Cells: RAM, queues, register stage, multiplier, reset, clock gate")
    d.box("ram", 0, 0, "slog_ram|one write, one read,|output register", "memory")
    d.box("ram_fifo", 1, 0, "slog_ram_fifo|queue in block RAM", "memory")
    d.box("fifo", 2, 0, "slog_fifo|queue in registers", "memory")
    d.box("stage", 3, 0, "slog_stage|one register between|two handshakes")
    d.box("mult", 0, 1, "slog_mult|18 x 18 bits,|3 registers")
    d.box("reset", 1, 1, "slog_reset|pin to all registers,|3 clocks")
    d.box("buffer", 2, 1, "slog_reset_buffer|a wire; a global net|on the ECP5")
    d.box("gate", 3, 1, "slog_clock_gate|fast simulation|build only")
    d.arrow("ram", "ram_fifo", "storage")
    d.arrow("fifo", "ram_fifo", "output")
    d.arrow("reset", "buffer")
    return d


DIAGRAMS = {f.__name__: f for f in (board, cells, frontend, store, correlator, array, peak, control)}


def main() -> None:
    """Write every diagram."""
    IMAGES.mkdir(exist_ok=True)
    for name, make in DIAGRAMS.items():
        (IMAGES / f"{name}.svg").write_text(make().svg())


if __name__ == "__main__":
    main()
