# SPDX-License-Identifier: Apache-2.0
"""A flat netlist of ECP5 cells as plain Verilog: look-up tables and carries as expressions, registers as statements.

For Icarus, which needs hours for tens of thousands of instances, or of nets in one scope, which it searches for every
use of a net. So nets are words of one array, `n` with their number in the netlist, and cells lie in blocks of CHUNK.
The expressions are those of the models in `sim/synth/gates.sv`, with the cells' constants in place: unknown values
spread as there. Memories and multipliers stay instances. Bits of input ports keep their names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

Cell = Mapping[str, Any]
Namer = Callable[[Any], str]
"""Verilog for a bit of the netlist: a number, or a constant."""
INSTANCES = ("DP16KD", "MULT18X18D", "TRELLIS_DPR16X4", "DCCA")
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


def _value(cell: Cell, name: str, default: str = "") -> str:
    return str(cell["parameters"].get(name, default)).strip()


def _pins(cell: Cell, net: Namer) -> dict[str, str]:
    """Verilog of each single-bit pin that is connected."""
    return {pin: net(bits[0]) for pin, bits in cell["connections"].items() if len(bits) == 1}


def register(number: int, cell: Cell, net: Namer) -> str:
    """The statement of a TRELLIS_FF, whose value is in `q` and its number.

    Raises:
        ValueError: if it is in a mode that `gates.sv` does not model.
    """
    if (_value(cell, "SRMODE", "LSR_OVER_CE") == "ASYNC" or _value(cell, "CLKMUX", "CLK") != "CLK"
            or _value(cell, "LSRMODE", "LSR") != "LSR"):
        raise ValueError(f"register in a mode that is not modelled: {cell['parameters']}")
    pins = _pins(cell, net)

    def control(pin: str, mux: str, absent: str) -> str:
        value = pins.get(pin, absent)
        return {"0": "1'b0", "1": "1'b1", "INV": f"~{value}"}.get(_value(cell, mux), value)

    q = f"q{number}"
    enable, reset = control("CE", "CEMUX", "1'b1"), control("LSR", "LSRMUX", "1'b0")
    value, kept = f"1'b{int(_value(cell, 'REGSET', 'RESET') == 'SET')}", q
    data = pins["M"] if _value(cell, "SD", "1") == "0" else pins["DI"]
    if _value(cell, "SRMODE", "LSR_OVER_CE") == "LSR_OVER_CE":
        inner = data if enable == "1'b1" else f"{enable} ? {data} : {kept}"
        return f"{q} <= {inner if reset == _NEVER else f'{reset} ? {value} : {inner}'};"
    inner = data if reset == _NEVER else f"({reset} ? {value} : {data})"
    return f"{q} <= {inner if enable == _ALWAYS else f'{enable} ? {inner} : {kept}'};"


_NEVER, _ALWAYS = "1'b0", "1'b1"


def logic(number: int, cell: Cell, net: Namer) -> Iterator[str]:
    """The lines of a cell of combinational logic."""
    pins = _pins(cell, net)
    kind = cell["type"]
    if kind == "LUT4":
        inputs = tuple(pins[pin] for pin in "ABCD")
        yield f"assign {pins['Z']} = {lut(int(_value(cell, 'INIT'), 2), inputs)};"
    elif kind == "PFUMX":
        yield f"assign {pins['Z']} = {pins['C0']} ? {pins['ALUT']} : {pins['BLUT']};"
    elif kind == "L6MUX21":
        yield f"assign {pins['Z']} = {pins['SD']} ? {pins['D1']} : {pins['D0']};"
    elif kind == "CCU2C":
        carry = pins["CIN"]
        for k in range(2):
            init, apart = int(_value(cell, f"INIT{k}"), 2), _value(cell, f"INJECT1_{k}") == "YES"
            whole = lut(init, tuple(pins[f"{pin}{k}"] for pin in "ABCD"))
            low = "1'b0" if apart else lut(init & 15, tuple(pins[f"{pin}{k}"] for pin in "AB"))
            yield f"wire whole{number}_{k} = {whole};"
            if f"S{k}" in pins:
                yield f"assign {pins[f'S{k}']} = whole{number}_{k}{'' if apart else f' ^ {carry}'};"
            yield f"wire carry{number}_{k} = whole{number}_{k} ? {carry} : {low};"
            carry = f"carry{number}_{k}"
        if "COUT" in pins:
            yield f"assign {pins['COUT']} = {carry};"
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
            lines += [instance(number, cell, net)] if cell["type"] in INSTANCES else logic(number, cell, net)
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
