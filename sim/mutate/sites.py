# SPDX-License-Identifier: Apache-2.0
"""Finds every place of a module where one small change makes a mutant.

Only what a circuit computes is changed: declarations, parameters, generate conditions, bounds of loops and of slices
and initial values stay as they are, because a build holds all mutants of a module at once. Assertions, and what only
they use, are no circuit.
"""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from sim.mutate import operators
from sim.mutate.tree import Node, parse

SKIPPED = frozenset({
    "kParamDeclaration", "kFormalParameterListDeclaration", "kPortDeclarationList", "kActualParameterList",
    "kPackedDimensions", "kUnpackedDimensions", "kGenerateIfHeader", "kLoopHeader", "kMacroCall", "kTypeDeclaration",
    "kPackageImportDeclaration", "kPackageImportList", "kFunctionHeader", "kEventControl", "kLPValue", "kSystemTFCall",
    "kLocalRoot", "kDimensionRange", "kInitialStatement", "kInstantiationType"})
"""Parts of a tree in which nothing is changed."""
CLOCK_GATE = b"slog_clock_gate "
"""Its enable acts in the fast simulation build only; elsewhere it is a wire, so what drives it is no circuit."""
STATEMENTS = frozenset({"kNonblockingAssignmentStatement", "kNetVariableAssignment", "kAssignModifyStatement",
                        "kIfHeader", "kCaseStatement", "kActualNamedPort", "kJumpStatement", "kTrailingAssign"})
"""What names a mutant: the nearest of these around it."""


@dataclass(frozen=True)
class Mutant:
    """One change of one module.

    Attributes:
        name: module and a digest of the changed statement; it stays while that statement does.
        module: name of the file, in `rtl/ecp5` with that folder.
        operator: what was done.
        start: first byte of what is replaced.
        end: byte after it.
        original: text that is replaced.
        changed: text put in its place; of a statement that is dropped, empty.
        line: in the file, from 1.
    """

    name: str
    module: str
    operator: str
    start: int
    end: int
    original: str
    changed: str
    line: int

    @property
    def statement(self) -> bool:
        """A statement is dropped, instead of an expression replaced."""
        return not self.changed

    def __str__(self) -> str:
        what = "dropped" if self.statement else f"-> {_short(self.changed)}"
        return f"{self.name} line {self.line}, {self.operator}: {_short(self.original)} {what}"


def _short(text: str) -> str:
    words = " ".join(text.split())
    return words if len(words) <= 70 else words[:67] + "..."


@dataclass
class Spot:
    """Surroundings a node lies: its nearest statement, and whether that is clocked."""

    statement: Node
    clocked: bool = False
    body: bool = False
    reset: bool = False


class Finder:
    """All mutants of one file.

    Args:
        path: of the file.
        module: its name in the names of mutants.
    """

    def __init__(self, path: Path, module: str) -> None:
        self.source = path.read_bytes()
        self.module = module
        self.tree = parse(path)
        self.types = _declared(self.tree, self.source)
        self.constant = _constant_functions(self.tree, self.source)
        self.unsynthesised = [match.span() for match in re.finditer(rb"`ifn?def (SYNTHESIS|SLOG_CLOCK_GATE)\b.*?`endif",
                                                                    self.source, re.DOTALL)]
        self.seen: Counter[tuple[str, ...]] = Counter()
        self.statements: dict[int, int] = {}

    def mutants(self) -> list[Mutant]:
        """Every mutant, in the order of the text; none twice."""
        found: dict[tuple[int, int, str], Mutant] = {}
        for node, place in self._nodes(self.tree, Spot(self.tree)):
            if any(start <= node.start < end for start, end in self.unsynthesised):
                continue
            for operator, changed in operators.changes(node, self.source, place, self.types):
                mutant = self._mutant(node, place, operator, changed)
                found.setdefault((mutant.start, mutant.end, mutant.changed), mutant)
        return sorted(found.values(), key=lambda mutant: (mutant.start, -mutant.end))

    def _mutant(self, node: Node, place: Spot, operator: str, changed: str) -> Mutant:
        statement = " ".join(place.statement.text(self.source).split())
        copy = self.statements.setdefault(place.statement.start, self._copy(statement))
        where = str(node.start - place.statement.start)
        digest = hashlib.sha256("\0".join((statement, str(copy), where, operator, changed)).encode()).hexdigest()
        return Mutant(f"{self.module.removeprefix('slog_').replace('/slog_', '/')}-{digest[:8]}", self.module, operator,
                      node.start, node.end, node.text(self.source), changed,
                      self.source.count(b"\n", 0, node.start) + 1)

    def _copy(self, statement: str) -> int:
        """How many statements of the same text came before."""
        self.seen[statement,] += 1
        return self.seen[statement,] - 1

    def _nodes(self, node: Node, place: Spot) -> Iterator[tuple[Node, Spot]]:
        """Nodes that may be changed, with their places."""
        if node.tag in SKIPPED or (node.tag == "kFunctionDeclaration" and self._name(node) in self.constant):
            return
        if node.tag == "kDataDeclaration" and self.source.startswith(CLOCK_GATE, node.start):
            return
        if node.tag == "kAlwaysStatement":
            place = Spot(node, clocked=node.children[0].tag == "always_ff", body=True)
        elif node.tag == "kFunctionDeclaration":
            place = Spot(node, body=True)
        elif node.tag == "kRegisterVariable" and not place.body:
            return
        if node.tag in STATEMENTS:
            place = Spot(node, place.clocked, place.body, place.reset)
        yield node, place
        for child in self._open(node):
            inner = place
            if node.tag == "kIfClause" and child.tag == "kIfBody":
                header = " ".join(node.children[0].text(self.source).split())
                inner = Spot(place.statement, place.clocked, place.body,
                              place.reset or bool(re.fullmatch(r"if \((rst_\w+|\w+_rst\w*)\)", header)))
            yield from self._nodes(child, inner)

    def _open(self, node: Node) -> list[Node]:
        """The children that hold run-time expressions."""
        children = node.children
        if node.tag in ("kCast", "kCaseItem"):
            return children[1:]  # the width or type; the labels
        if node.tag == "kPatternExpression":
            return children[2:]  # the field's name
        if node.tag == "kDimensionSlice":
            return children[1:2]  # the width
        if node.tag == "kReference" and any(child.tag == "kHierarchyExtension" for child in children):
            last = max(n for n, child in enumerate(children) if child.tag == "kHierarchyExtension")
            return children[last + 1:]
        if node.tag == "kExpression" and len(children) > 2 and children[0].tag == "{":
            return children[2:]  # the number of copies is a constant
        if node.tag == "kActualNamedPort":
            return [] if _only_reference(node) else children
        return children

    def _name(self, function: Node) -> str:
        return next(n.text(self.source) for n in function.children[0].children if n.tag == "kUnqualifiedId")


def _only_reference(port: Node) -> bool:
    """The port is connected to something that can be assigned to, so it may be an output."""
    changed = ("kBinaryExpression", "kUnaryPrefixExpression", "kConditionExpression", "kNumber", "kCast")
    return not any(n.tag in changed for n in _outside_dimensions(port))


def _outside_dimensions(node: Node) -> Iterator[Node]:
    yield node
    for child in node.children:
        if not child.tag.startswith("kDimension"):
            yield from _outside_dimensions(child)


def _declared(tree: Node, source: bytes) -> dict[str, str]:
    """Types of signals and ports as they are written, by name."""
    types: dict[str, str] = {}
    for node in tree.walk():
        if node.tag == "kInstantiationBase":
            kind = node.children[0].text(source)
            for variable in node.walk():
                if variable.tag == "kRegisterVariable":
                    size = "".join(n.text(source) for n in variable.children if n.tag == "kUnpackedDimensions")
                    types[variable.children[0].text(source)] = "".join((kind + size).split())
        elif node.tag == "kPortDeclaration":
            kind = "".join(n.text(source) for n in node.children if n.tag == "kDataType")
            types |= {n.text(source): "".join(kind.split()) for n in node.children if n.tag == "kUnqualifiedId"}
    return types


def _constant_functions(tree: Node, source: bytes) -> frozenset[str]:
    """Names of functions that parameters, sizes or generate conditions call."""
    names: set[str] = set()
    for node in tree.walk():
        if node.tag in SKIPPED - {"kMacroCall", "kLPValue", "kLocalRoot"}:
            names |= {call.children[0].text(source) for call in node.walk() if call.tag == "kReferenceCallBase"}
    return frozenset(names)


def mutants_of(path: Path, module: str | None = None) -> list[Mutant]:
    """Every mutant of a file.

    Args:
        path: of the file.
        module: its name in the mutants' names; by default the file's.

    Raises:
        RuntimeError: if the file cannot be parsed.
    """
    return Finder(path, module or path.stem).mutants()
