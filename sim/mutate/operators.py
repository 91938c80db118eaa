# SPDX-License-Identifier: Apache-2.0
"""The mutation operators: what may stand in place of a node of the syntax tree.

Every replacement of an expression has at most the width of what it replaces, because both stand in one conditional
expression, which is as wide as the wider one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Protocol

from sim.mutate.tree import Node

SWAPS = {
    "&&": ("||",), "||": ("&&",), "==": ("!=",), "!=": ("==",), "<": ("<=", ">="), "<=": ("<", ">"),
    ">": (">=", "<="), ">=": (">", "<"), "+": ("-",), "-": ("+",), "*": ("+",), "&": ("|",), "|": ("&",),
    "^": ("|",), "<<": (">>",), ">>": ("<<",), ">>>": (">>",), "<<<": (">>",),
}
"""Binary operators and what takes their place."""
DROPPED = frozenset({"&&", "||", "&", "|", "^", "+", "-", "<<", ">>", ">>>"})
"""Binary operators of which an operand may be missing."""
UNARY = {"!": "", "~": "", "-": "", "&": "|", "|": "&", "^": "|"}
"""Unary operators and what takes their place."""
ASSIGNMENTS = ("kNonblockingAssignmentStatement", "kNetVariableAssignment", "kAssignModifyStatement")
STAGES = ("_i", "_d", "_q", "_q2", "_q3", "")
"""Ends of the names of one signal in its pipeline stages."""


class Surroundings(Protocol):
    """What the operators know of a node's surroundings."""

    statement: Node
    clocked: bool
    body: bool
    reset: bool


def changes(node: Node, source: bytes, place: Surroundings, types: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Names of operators, each with the text that it puts in place of `node`; an empty text drops a statement.

    Args:
        node: any node that is not in a constant's place.
        source: of the file.
        place: of the node.
        types: of the module's signals, as they are declared.
    """
    text = node.text(source)
    if node.tag == "kBinaryExpression":
        yield from _binary(node, source)
    elif node.tag == "kUnaryPrefixExpression":
        yield from _unary(node, source)
    elif node.tag == "kConditionExpression":
        condition, then, other = (node.children[n].text(source) for n in (0, 2, 4))
        yield "ternary swapped", f"({condition}) ? ({other}) : ({then})"
        yield "ternary: first", then
        yield "ternary: second", other
    elif node.tag == "kNumber":
        yield from (("constant", other) for other in _numbers(text))
    elif node.tag == "kReference":
        yield from _reference(node, source, place, types)
    elif node.tag == "kIfHeader":
        return
    elif node.tag in ASSIGNMENTS and place.body:
        yield ("reset value dropped" if place.reset else "assignment dropped"), ""
    elif node.tag == "kParenGroup" and place.statement.tag == "kIfHeader" and node in place.statement.children:
        yield "condition negated", f"!{text}"
    if node.tag == "kExpression" and place.statement.tag in ASSIGNMENTS and node is place.statement.children[2] \
            and place.statement.tag != "kAssignModifyStatement" and not place.reset:
        yield from _narrow(place.statement, node, source)


def _binary(node: Node, source: bytes) -> Iterator[tuple[str, str]]:
    """`a op b op c`: one operator changed, or one operand missing."""
    words = [child.text(source) for child in node.children]
    for n in range(1, len(words), 2):
        for other in SWAPS.get(words[n], ()):
            yield f"{words[n]} to {other}", " ".join([*words[:n], other, *words[n + 1:]])
        if words[n] in DROPPED:
            yield f"operand of {words[n]} dropped", " ".join(words[:n] + words[n + 2:])
            if n == 1 and words[n] in ("&&", "||", "&", "|", "^"):
                yield f"operand of {words[n]} dropped", " ".join(words[2:])


def _unary(node: Node, source: bytes) -> Iterator[tuple[str, str]]:
    operator, operand = node.children[0].text(source), node.children[1].text(source)
    if operator in UNARY:
        yield f"{operator} changed", UNARY[operator] + operand


def _numbers(text: str) -> list[str]:
    """Neighbours of a number, of the same width."""
    if text in ("'0", "'1"):
        return ["'1" if text == "'0" else "'0"]
    match = re.fullmatch(r"(?:(\d+)?'([bdh]))?([0-9a-fA-F_]+)", text.replace(" ", ""))
    if not match:
        return []
    bits, base, digits = match.groups()
    value = int(digits.replace("_", ""), {"b": 2, "h": 16}.get(base or "d", 10))
    if bits is None:
        return [str(n) for n in (value + 1, value - 1) if n >= 0]
    near = dict.fromkeys((value + step) % (1 << int(bits)) for step in (1, -1))
    return [f"{bits}'d{n}" for n in near]


def _reference(node: Node, source: bytes, place: Surroundings, types: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Another stage of the same signal; a slice that lacks its top bit, or lies one bit higher."""
    text, name = node.text(source), node.children[0].text(source)
    match = re.fullmatch(r"(.*?)(_i|_d|_q\d?|)", name)
    if match and name in types:
        stem, own = match.groups()
        for end in STAGES:
            other = stem + end
            # A combinational signal is read by registers only: elsewhere a loop could arise.
            if end != own and types.get(other) == types[name] and (end.startswith("_q") or place.clocked):
                yield f"{name} to {other}", other + text[len(name):]
    if node.children[-1].tag in ("kDimensionRange", "kDimensionSlice"):
        yield "top bit of a slice dropped", (f"($bits({text}))'({text} & "
                                             f"~(($bits({text}))'(1) << ($bits({text}) - 1)))")
        yield "slice shifted by one", f"($bits({text}))'({text} >> 1)"


def _narrow(statement: Node, value: Node, source: bytes) -> Iterator[tuple[str, str]]:
    """The top bit of a sum or difference is lost before it is assigned."""
    if not any(child.tag == "kBinaryExpression" and child.children[1].text(source) in "+-*"
               for child in value.children):
        return
    target, text = statement.children[0].text(source), value.text(source)
    yield "top bit of a sum dropped", f"(({text}) & ~(($bits({target}))'(1) << ($bits({target}) - 1)))"
