# SPDX-License-Identifier: Apache-2.0
"""A flat netlist of ECP5 cells as plain Verilog: look-up tables and carries as expressions, registers as statements.

For Icarus, which needs hours for tens of thousands of instances, or of nets in one scope, which it searches for every
use of a net. So nets are words of one array, `n` with their number in the netlist, and cells lie in blocks of CHUNK.
The cells are those that Yosys makes, or those that nextpnr packs them into (`sim.gates.routed`). The expressions are
those of the models in `sim/synth/gates.sv` and `routed.sv`, with the cells' constants in place: unknown values spread
as there. Memories and multipliers stay instances. Bits of input ports keep their names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

Cell = Mapping[str, Any]
Namer = Callable[[Any], str]
"""Verilog for a bit of the netlist: a number, or a constant."""
INSTANCES = ("DP16KD", "MULT18X18D", "TRELLIS_DPR16X4", "DCCA")
RAMW = {"WADO0": "D0", "WADO1": "B0", "WADO2": "C0", "WADO3": "A0",
        "WDO0": "C1", "WDO1": "A1", "WDO2": "D1", "WDO3": "B1"}
"""Which input of TRELLIS_RAMW each of its outputs is."""
CHUNK = 100
"""Cells of one block."""


def lut(init: int, inputs: tuple[str, ...]) -> str:
    """The expression of a look-up table.

    Args:
        init: its 2 ** len(inputs) bits.
        inputs: expressions, the lowest address bit first.
    """
    if not inputs:
        return f"1'b{init & 1}"
    half = 1 << (len(inputs) - 1)
    low, high = init & (1 << half) - 1, init >> half & (1 << half) - 1
    if low == high:
        return lut(low, inputs[:-1])
    if {low, high} == {0, (1 << half) - 1}:
        return inputs[-1] if high else f"~{inputs[-1]}"
    return f"({inputs[-1]} ? {lut(high, inputs[:-1])} : {lut(low, inputs[:-1])})"


def value(cell: Cell, name: str, default: str = "") -> str:
    """A parameter's value as text: a space after binary digits, which marks them as text, is no part of it."""
    return str(cell["parameters"].get(name, default)).strip()


def _pins(cell: Cell, net: Namer) -> dict[str, str]:
    """Verilog of each single-bit pin that is connected."""
    return {pin: net(bits[0]) for pin, bits in cell["connections"].items() if len(bits) == 1}


def register(number: int, cell: Cell, net: Namer) -> str:
    """The statement of a TRELLIS_FF, whose value is in `q` and its number.

    Raises:
        ValueError: if it is in a mode that `gates.sv` does not model.
    """
    if (value(cell, "SRMODE", "LSR_OVER_CE") == "ASYNC" or value(cell, "CLKMUX", "CLK") != "CLK"
            or value(cell, "LSRMODE", "LSR") != "LSR"):
        raise ValueError(f"register in a mode that is not modelled: {cell['parameters']}")
    pins = _pins(cell, net)

    def control(pin: str, mux: str, absent: str) -> str:
        driver = pins.get(pin, absent)
        return {"0": "1'b0", "1": "1'b1", "INV": f"~{driver}"}.get(value(cell, mux), driver)

    q = f"q{number}"
    enable, reset = control("CE", "CEMUX", "1'b1"), control("LSR", "LSRMUX", "1'b0")
    start, kept = f"1'b{int(value(cell, 'REGSET', 'RESET') == 'SET')}", q
    data = pins["M"] if value(cell, "SD", "1") == "0" else pins["DI"]
    if value(cell, "SRMODE", "LSR_OVER_CE") == "LSR_OVER_CE":
        inner = data if enable == "1'b1" else f"{enable} ? {data} : {kept}"
        return f"{q} <= {inner if reset == _NEVER else f'{reset} ? {start} : {inner}'};"
    inner = data if reset == _NEVER else f"({reset} ? {start} : {data})"
    return f"{q} <= {inner if enable == _ALWAYS else f'{enable} ? {inner} : {kept}'};"


_NEVER, _ALWAYS = "1'b0", "1'b1"


def _carry(name: str, half: tuple[str, str, tuple[str, ...]], carry: str, total: str) -> Iterator[str]:
    """Half of a carry cell: table, `YES` if apart from the carry, inputs; `carry` comes in, carry`name` goes out."""
    init, apart, inputs = int(half[0], 2), half[1] == "YES", half[2]
    low = "1'b0" if apart else lut(init & 15, inputs[:2])
    yield f"wire whole{name} = {lut(init, inputs)};"
    if total:
        yield f"assign {total} = whole{name}{'' if apart else f' ^ {carry}'};"
    yield f"wire carry{name} = whole{name} ? {carry} : {low};"


def _half_slice(number: int, cell: Cell, pins: Mapping[str, str]) -> Iterator[str]:
    """A look-up table as nextpnr packs it, but for those that are memories."""
    inputs = tuple(pins[pin] for pin in "ABCD")
    sum_ = f"f{number}"
    yield f"wire {sum_};"
    if value(cell, "MODE") == "CCU2":
        yield from _carry(f"{number}", (value(cell, "INITVAL"), value(cell, "CCU2_INJECT1"), inputs), pins["FCI"], sum_)
        if "FCO" in pins:
            yield f"assign {pins['FCO']} = carry{number};"
    else:
        yield f"assign {sum_} = {lut(int(value(cell, 'INITVAL'), 2), inputs)};"
    if "F" in pins:
        yield f"assign {pins['F']} = {sum_};"
    if "OFX" in pins:
        low, high = (sum_, pins["F1"]) if value(cell, "MUX") == "F1" else (pins["FXA"], pins["FXB"])
        yield f"assign {pins['OFX']} = {pins['M']} ? {high} : {low};"


def stays(cell: Cell) -> bool:
    """Whether a cell stays an instance of its model."""
    return cell["type"] in INSTANCES or (cell["type"] == "TRELLIS_COMB" and value(cell, "MODE") == "DPRAM")


def logic(number: int, cell: Cell, net: Namer) -> Iterator[str]:
    """The lines of a cell of combinational logic."""
    pins = _pins(cell, net)
    kind = cell["type"]
    if kind == "LUT4":
        inputs = tuple(pins[pin] for pin in "ABCD")
        yield f"assign {pins['Z']} = {lut(int(value(cell, 'INIT'), 2), inputs)};"
    elif kind == "PFUMX":
        yield f"assign {pins['Z']} = {pins['C0']} ? {pins['ALUT']} : {pins['BLUT']};"
    elif kind == "L6MUX21":
        yield f"assign {pins['Z']} = {pins['SD']} ? {pins['D1']} : {pins['D0']};"
    elif kind == "CCU2C":
        carry = pins["CIN"]
        for k in range(2):
            half = (value(cell, f"INIT{k}"), value(cell, f"INJECT1_{k}"), tuple(pins[f"{pin}{k}"] for pin in "ABCD"))
            yield from _carry(f"{number}_{k}", half, carry, pins.get(f"S{k}", ""))
            carry = f"carry{number}_{k}"
        if "COUT" in pins:
            yield f"assign {pins['COUT']} = {carry};"
    elif kind == "TRELLIS_COMB":
        yield from _half_slice(number, cell, pins)
    elif kind == "TRELLIS_RAMW":
        for sink, source in RAMW.items():
            if sink in pins:
                yield f"assign {pins[sink]} = {pins[source]};"
    elif kind in ("TRELLIS_IO_INPUT", "TRELLIS_IO_OUTPUT"):
        yield f"assign {pins['O']} = {pins['B']};" if kind.endswith("INPUT") else f"assign {pins['B']} = {pins['I']};"
    else:
        raise ValueError(f"cell {kind} is not modelled")


def _parameter(value: str) -> str:
    """A parameter's value as Verilog: binary digits are a number, a space after them makes them a string."""
    return f"{len(value)}'b{value}" if value and set(value) <= set("01") else f'"{value.strip()}"'


def instance(number: int, cell: Cell, net: Namer) -> str:
    """The line of a cell that stays one."""
    parameters = ", ".join(f".{name}({_parameter(value)})" for name, value in cell["parameters"].items())
    pins = ", ".join(f".{pin}({{{', '.join(net(bit) for bit in reversed(bits))}}})"
                     for pin, bits in cell["connections"].items() if bits)
    return f"{cell['type']} #({parameters}) cell{number} ({pins});"


def names_of_inputs(module: Mapping[str, Any]) -> dict[int, str]:
    """Verilog of the bits of input ports."""
    return {bit: f"{name}[{k}]" if len(port["bits"]) > 1 else name
            for name, port in module["ports"].items() if port["direction"] == "input"
            for k, bit in enumerate(port["bits"])}


def namer(module: Mapping[str, Any]) -> Namer:
    """Verilog for every bit of a module's nets."""
    inputs = names_of_inputs(module)
    return lambda bit: inputs.get(bit, f"n[{bit}]") if isinstance(bit, int) else f"1'b{bit}"


def verilog(name: str, module: Mapping[str, Any]) -> str:
    """The module as Verilog.

    Raises:
        ValueError: if a cell or its mode is not modelled, or registers have different clocks.
    """
    net = namer(module)
    ports = ", ".join(f"{port['direction']} [{len(port['bits']) - 1}:0] {called}" if len(port["bits"]) > 1
                      else f"{port['direction']} {called}" for called, port in module["ports"].items())
    cells = [cell for cell in module["cells"].values() if not cell["type"].startswith("$")]  # $scopeinfo is no logic
    registers = [cell for cell in cells if cell["type"] == "TRELLIS_FF"]
    clocks = {net(cell["connections"]["CLK"][0]) for cell in registers}
    if len(clocks) != 1:
        raise ValueError(f"registers have the clocks {', '.join(sorted(clocks))}: one was expected")
    clock = next(iter(clocks))
    top = max(bit for cell in cells for bits in cell["connections"].values() for bit in bits if isinstance(bit, int))
    lines = [f"module {name} ({ports});", f"wire n[0:{top}];"]
    others = [(number, cell) for number, cell in enumerate(cells) if cell["type"] != "TRELLIS_FF"]
    for first in range(0, len(others), CHUNK):
        lines.append(f"if (1) begin : logic{first}")
        for number, cell in others[first:first + CHUNK]:
            lines += [instance(number, cell, net)] if stays(cell) else logic(number, cell, net)
        lines.append("end")
    for first in range(0, len(registers), CHUNK):
        here = list(enumerate(registers[first:first + CHUNK]))
        lines += [f"if (1) begin : registers{first}",
                  *(f"reg q{k}; assign {net(cell['connections']['Q'][0])} = q{k};" for k, cell in here),
                  f"always @(posedge {clock}) begin", *(register(k, cell, net) for k, cell in here), "end", "end"]
    lines += [f"assign {called}{f'[{k}]' if len(port['bits']) > 1 else ''} = {net(bit)};"
              for called, port in module["ports"].items() if port["direction"] == "output"
              for k, bit in enumerate(port["bits"])]
    return "\n".join([*lines, "endmodule", ""])
