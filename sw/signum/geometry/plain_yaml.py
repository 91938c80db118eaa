# SPDX-License-Identifier: Apache-2.0
"""YAML of ROS and Kalibr by PyYAML, which the extra `ros` installs."""

from __future__ import annotations

from typing import Any

import yaml


def parse_yaml(text: str) -> Any:
    """The first document of a YAML text.

    Raises:
        ValueError: if it is none; its message is the number of the line, or empty.
    """
    try:
        return next(iter(yaml.load_all(text, _Loader)), None)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        raise ValueError(f"line {mark.line + 1}" if mark else "") from error


class _Loader(yaml.SafeLoader):
    """Plain YAML, with OpenCV's mark of a matrix, but without references, by which a small file could make a large
    tree."""

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("references")
        return super().compose_node(parent, index)


def _matrix_mark(loader: yaml.SafeLoader, node: yaml.MappingNode) -> dict[Any, Any]:
    return loader.construct_mapping(node, deep=True)


_Loader.add_constructor("tag:yaml.org,2002:opencv-matrix", _matrix_mark)
