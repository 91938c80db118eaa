# SPDX-License-Identifier: Apache-2.0
"""Draws the timing diagrams of the documentation: `python -m docs.tools.waves [ROOM...]` writes `docs/img/waves-*.svg`.

Each is taken from a simulation of the RTL. The test `timing_diagram` of the module's bench in `cocotb_tests/` drives
the inputs below, records the ports and draws them, one column per clock, with the values just before its rising edge.
When the regression runs it, it compares the picture with the one that is kept.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from golden.correlate import Job
from golden.cycle.dense.structs import BACK, WINNER
from golden.cycle.model import Inputs, Stimulus
from golden.params import TINY
from golden.structs import JOB, Layout, pack_job
from sim.registers.map import address
from sim.testbench.runner import AXI_PORTS, simulate

IMAGES = Path(__file__).resolve().parents[1] / "img"
NAME_W, CLOCK_W, ROW_H, HIGH = 132, 26, 30, 18
FONT = 'font-family="Roboto Mono, Menlo, Consolas, monospace"'


class Signal(NamedTuple):
    """A port to draw: a level, or a bus whose value is shown while `valid` (another port) is 1, each clock by itself
    unless `held`."""

    name: str
    bus: bool = False
    valid: str = ""
    hexadecimal: bool = False
    held: bool = False


class Wave(NamedTuple):
    """A picture: the module's bench (a module of `cocotb_tests`, its top and parameters), its title, the inputs clock
    by clock, the ports to draw, the first clock drawn, the prefix of the module's ports in the bench, and ports of
    which fields are drawn."""

    bench: str
    top: str
    parameters: dict[str, int]
    title: str
    inputs: Sequence[Inputs]
    signals: Sequence[Signal]
    start: int = 0
    prefix: str = ""
    fields: Mapping[str, Layout] = MappingProxyType({})


Seen = dict[str, int | None]
"""Values of a clock by port name; None where they mean nothing."""


def stimulus(wave: Wave, ports: Iterable[str]) -> Stimulus:
    """The wave's inputs for all these input ports of a bench, clock by clock."""
    idle = dict.fromkeys(ports, 0)
    for i in wave.inputs:
        yield idle | {wave.prefix + name: value for name, value in i.items()}


def ports(wave: Wave, values: Seen) -> Seen:
    """The ports of a wave's module and their fields, out of all that a bench has recorded in a clock."""
    own = {name.removeprefix(wave.prefix): value for name, value in values.items()}
    for port, layout in wave.fields.items():
        own |= {f"{port}.{name}": value for name, value in layout.unpack(own[port] or 0).items()}
    return own


def draw(wave: Wave, clocks: Sequence[Seen]) -> str:
    """The picture of these clocks as SVG."""
    seen = clocks[wave.start:]
    width, height = NAME_W + CLOCK_W * len(seen) + 12, ROW_H * (len(wave.signals) + 1) + 14
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
             f'height="{height}" role="img" '
             f'aria-label="{escape(wave.title)}">', f"<title>{escape(wave.title)}</title>",
             f'<rect width="{width}" height="{height}" rx="6" fill="#fafafa"/>']
    for k in range(len(seen)):
        x = NAME_W + k * CLOCK_W
        parts.append(f'<path d="M{x} 6V{height - 6}" stroke="#cfd8dc" stroke-width="0.7"/>')
        if k % 5 == 0:
            parts.append(f'<text x="{x + CLOCK_W / 2:g}" y="18" {FONT} font-size="10" fill="#607d8b" '
                         f'text-anchor="middle">{k}</text>')
    parts.append(f'<text x="8" y="18" {FONT} font-size="10" fill="#607d8b">clock</text>')
    for row, signal in enumerate(wave.signals):
        base = ROW_H * (row + 1) + ROW_H - 4
        parts += [f'<text x="8" y="{base - 5}" {FONT} font-size="12" fill="#102027">{signal.name}</text>',
                  _bus(signal, seen, base) if signal.bus else _level(signal, seen, base)]
    return "\n".join([*parts, "</svg>", ""])


def _level(signal: Signal, seen: Sequence[Seen], base: int) -> str:
    path = ""
    for k, values in enumerate(seen):
        y = base - HIGH * bool(values[signal.name])
        path += f"{'M' if k == 0 else 'L'}{NAME_W + k * CLOCK_W} {y}H{NAME_W + (k + 1) * CLOCK_W}"
    return f'<path d="{path}" fill="none" stroke="#00796b" stroke-width="1.7"/>'


def _bus(signal: Signal, seen: Sequence[Seen], base: int) -> str:
    out, k = [], 0
    while k < len(seen):
        value = _shown(signal, seen[k])
        last = k + 1
        merges = value is None or signal.held or not signal.valid
        while merges and last < len(seen) and _shown(signal, seen[last]) == value:
            last += 1
        x0, x1 = NAME_W + k * CLOCK_W, NAME_W + last * CLOCK_W
        fill = "#eceff1" if value is None else "#e0f2f1"
        middle = base - HIGH / 2
        out.append(f'<path d="M{x0 + 3} {base - HIGH}H{x1 - 3}L{x1} {middle:g}L{x1 - 3} {base}H{x0 + 3}'
                   f'L{x0} {middle:g}Z" fill="{fill}" stroke="#00796b" stroke-width="1"/>')
        if value is not None:
            text = f"{value:x}" if signal.hexadecimal else str(value)
            room = max(6.0, min(10.5, (x1 - x0 - 5) / (0.6 * len(text))))
            out.append(f'<text x="{(x0 + x1) / 2:g}" y="{base - 5.5:g}" {FONT} font-size="{room:.3g}" fill="#102027" '
                       f'text-anchor="middle">{text}</text>')
        k = last
    return "".join(out)


def _shown(signal: Signal, values: Seen) -> int | None:
    return values[signal.name] if not signal.valid or values[signal.valid] else None


def cells() -> Wave:
    """A queue fills up, and empties."""
    inputs = [{"in_valid_i": int(k < 8), "in_data_i": 10 + min(k, 4) + max(0, k - 6), "out_ready_i": int(k >= 5)}
              for k in range(14)]
    return Wave("cells.test_fifo", "slog_fifo", {"Width": 8, "Depth": 4}, "slog_fifo, depth 4", inputs, (
        Signal("in_valid_i"), Signal("in_ready_o"), Signal("in_data_i", True, "in_valid_i"), Signal("out_valid_o"),
        Signal("out_ready_i"), Signal("out_data_o", True, "out_valid_o"), Signal("level_o", True)))


def frontend() -> Wave:
    """Two lines of 12 sign bits into words of 8."""
    bits = [1, 0, 1, 1, 0, 0, 1, 0, 1, 1, 0, 1]
    inputs = [{"bit_valid_i": 1, "bit_i": b, "bit_last_i": int(x == 11), "bit_start_i": int(x == y == 0),
               "bit_done_i": int(x == 11 and y == 1)} for y in range(2) for x, b in enumerate(bits)]
    return Wave("frontend.test_packer", "slog_packer", {"GroupBits": 8}, "slog_packer, words of 8 bits",
                [*inputs, *[{}] * 8], (
        Signal("bit_valid_i"), Signal("bit_i"), Signal("bit_last_i"), Signal("bit_start_i"), Signal("frame_start_o"),
        Signal("word_valid_o"), Signal("word_data_o", True, "word_valid_o", True), Signal("word_last_o"),
        Signal("frame_done_o")))


def store() -> Wave:
    """Two writes, two reads, and a peek that waits."""
    inputs: list[Inputs] = [{} for _ in range(30)]
    inputs[1] = {"wr_valid_i": 1, "wr_addr_i": 4, "wr_data_i": 0xA5}
    inputs[2] = {"wr_valid_i": 1, "wr_addr_i": 5, "wr_data_i": 0x3C}
    inputs[5] = {"rd_valid_i": 1, "rd_addr_i": 4, "peek_valid_i": 1, "peek_addr_i": 5}
    inputs[6] = {"rd_valid_i": 1, "rd_addr_i": 5}
    return Wave("store.test_store", "slog_store", {"Width": 8, "Words": 1424, "BankWords": 512, "SliceW": 4},
                "slog_store", inputs, (
        Signal("wr_valid_i"), Signal("wr_data_i", True, "wr_valid_i", True), Signal("rd_valid_i"),
        Signal("rd_addr_i", True, "rd_valid_i"), Signal("rd_data_o", True, "", True), Signal("peek_valid_i"),
        Signal("peek_ready_o"), Signal("peek_done_o"), Signal("peek_data_o", True, "peek_done_o", True)))


def correlator() -> Wave:
    """A grid of 2 x 2 jobs into a queue that is not ready for some clocks."""
    job = pack_job(Job(0, 8, 4, 8, 8, 1, 6, 2, 5, 5, tag=30))
    command = {"job_i": job, "count_x_i": 2, "count_y_i": 2, "step_x_i": 10, "step_y_i": 6}
    inputs = [{**command, "job_valid_i": int(k == 2), "job_ready_i": int(not 6 <= k < 10)} for k in range(18)]
    return Wave("correlator.test_grid", "slog_grid", {}, "slog_grid, 2 x 2 jobs", inputs, (
        Signal("job_valid_i"), Signal("job_ready_o"), Signal("job_ready_i"), Signal("job_valid_o"),
        Signal("job_o.tag", True, "job_valid_o"), Signal("job_o.tpl_x", True, "job_valid_o"),
        Signal("job_o.tpl_y", True, "job_valid_o")), fields={"job_o": JOB})


def array() -> Wave:
    """One pass of four rows of operands and five offsets."""
    rows = [{"valid_i": 1, "first_i": int(r == 0), "last_i": int(r == 3), "tpl_a_i": 0x5A >> r,
             "search_a_i": 0x35A >> r, "tpl_b_i": 0xC3 >> r, "search_b_i": 0x1C3 >> r} for r in range(4)]
    common = {"move_i": 1, "mask_i": 0xFFFF, "lanes_i": TINY.lanes}
    inputs = [{**common, **i} for i in [*[{}] * 24, *rows, *[{}] * 32]]
    return Wave("array.test_array", "slog_array", {"GroupBits": TINY.group_bits, "Lanes": TINY.lanes},
                "slog_array of tiny", inputs, (
        Signal("valid_i"), Signal("first_i"), Signal("last_i"), Signal("tpl_a_i", True, "valid_i", True),
        Signal("search_a_i", True, "valid_i", True), Signal("mismatch_valid_o"),
        Signal("mismatch_o", True, "mismatch_valid_o")), start=22)


def peak() -> Wave:
    """Two rows of scores; the second has its largest twice."""
    rows = [(9, 14, 31, 12), (20, 27, 27, 8)]
    inputs = [{"in_valid_i": 1, "in_first_i": int(x == 0), "in_last_i": int(x == 3), "in_value_i": v, "in_index_i": x}
              for row in rows for x, v in enumerate(row)]
    return Wave("peak.test_peak_parts", "tb_peak_parts", {"MaxOffsets": 48, "ScoreBits": 9, "ScoreDepth": 128},
                "slog_running_max", [{}, *inputs, *[{}] * 8], (
        Signal("in_valid_i"), Signal("in_first_i"), Signal("in_last_i"), Signal("in_value_i", True, "in_valid_i"),
        Signal("in_index_i", True, "in_valid_i"), Signal("out_valid_o"), Signal("out_value_o", True, "out_valid_o"),
        Signal("out_index_o", True, "out_valid_o")), prefix="max_")


def control() -> Wave:
    """A write and a read at once; the data of the read are taken late."""
    inputs: list[Inputs] = [{"s_axil_bready": 1, "s_axil_rready": int(k >= 17)} for k in range(34)]
    inputs[1] |= {"s_axil_awvalid": 1, "s_axil_awaddr": address("irq_enable"), "s_axil_wvalid": 1, "s_axil_wdata": 3,
                  "s_axil_wstrb": 15, "s_axil_arvalid": 1, "s_axil_araddr": address("id")}
    return Wave("control.test_control", "tb_control", {}, "slog_control, register access", inputs, (
        Signal("s_axil_awvalid"), Signal("s_axil_awready"), Signal("s_axil_wvalid"), Signal("s_axil_wready"),
        Signal("s_axil_bvalid"), Signal("s_axil_arvalid"), Signal("s_axil_arready"), Signal("s_axil_rvalid"),
        Signal("s_axil_rready"), Signal("s_axil_rdata", True, "s_axil_rvalid", True, held=True)))


def dense() -> Wave:
    """Rows of ten pixels under windows of 2x2; the right plane is the left one moved by two."""
    rows = ("1011001010", "0110101100", "1100110101")
    inputs: list[Inputs] = [*[{"flush_i": 1}] * 23, {}]
    for y, row in enumerate(rows):
        left = [int(c) for c in row]
        before = [int(c) for c in rows[y - 2]] if y >= 2 else [0] * len(left)
        for x in range(len(left)):
            moved, moved_before = (line[x + 2] if x < 8 else 0 for line in (left, before))
            inputs.append({"left_valid_i": 1, "right_valid_i": 1, "first_i": int(y == 0), "left_incoming_i": left[x],
                           "left_leaving_i": before[x], "right_incoming_i": moved, "right_leaving_i": moved_before,
                           "left_ok_i": int(min(x, y) >= 1) << y % 2,
                           "right_ok_i": int(min(x, y) >= 1 and x < 8) << y % 2})
        inputs += [{}] * 6
    common = {"offsets_i": 4}
    parameters = {"Offsets": 4, "Lanes": 2, "MaxWindow": 2, "Sizes": 1, "MaxWidth": 10}
    return Wave("dense.test_engine", "slog_dense_engine", parameters, "slog_dense_engine, four offsets",
                [{**common, **i} for i in [*inputs, *[{}] * 16]], (
        Signal("left_valid_i"), Signal("left_incoming_i"), Signal("right_incoming_i"), Signal("winner_valid_o"),
        Signal("winner_o.index", True, "winner_valid_o"), Signal("winner_o.best", True, "winner_valid_o"),
        Signal("back_valid_o"), Signal("back_o.index", True, "back_valid_o")), start=54,
                fields={"winner_o": WINNER, "back_o": BACK})


WAVES = {f.__name__: f for f in (cells, frontend, store, correlator, array, peak, control, dense)}


def main(names: Sequence[str]) -> None:
    """Simulate the rooms of these names, or all, and write their pictures."""
    IMAGES.mkdir(exist_ok=True)
    for name in names or WAVES:
        wave = WAVES[name]()
        ports = AXI_PORTS if name == "control" else ("*_i", "*_o")
        simulate(wave.top, f"cocotb_tests.{wave.bench}", wave.parameters, {"DIAGRAMS": "write"}, "timing_diagram",
                 ports=ports)


if __name__ == "__main__":
    main(sys.argv[1:])
