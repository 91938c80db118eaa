# SPDX-License-Identifier: Apache-2.0
"""`import signum` is quick and provides every name in `__all__`."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import signum


def _promised() -> dict[str, str]:
    """Name and module of what type checkers see in `signum/__init__.py`."""
    tree = ast.parse(Path(str(signum.__file__)).read_text())
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    return {alias.name: str(node.module) for node in block.body if isinstance(node, ast.ImportFrom)
            for alias in node.names}


def test_type_checkers_and_python_see_the_same_names() -> None:
    assert _promised() == signum._HOME and set(signum.__all__) == set(signum._HOME) <= set(dir(signum))
    for name, module in _promised().items():
        assert getattr(signum, name) is getattr(sys.modules[module], name)


def test_an_unknown_name() -> None:
    with pytest.raises(AttributeError, match="no attribute 'Measurar'"):
        _ = signum.Measurar  # type: ignore[attr-defined]


def test_a_host_script_needs_one_import() -> None:
    from signum import Measurer, Query, open_board
    with open_board("golden") as board:
        assert isinstance(board, signum.Board) and Measurer(board, (64, 48)).free_views == board.config.slots
    assert Query.__module__ == "signum.measure.measurer"


def test_import_is_quick_and_loads_no_library() -> None:
    path = [str(Path(str(signum.__file__)).parents[1]), str(Path(str(signum.__file__)).parents[2])]
    script = f"""
import sys, time
sys.path[:0] = {path!r}
began = time.process_time()  # not of what else the machine does
import signum
took = time.process_time() - began
from signum.common.errors import SignumError
print(took, *{{name.partition(".")[0] for name in sys.modules}})
"""
    took, *loaded = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True
                                   ).stdout.split()
    assert not {"cv2", "scipy", "numpy", "rich", "golden", "sim"} & set(loaded)
    assert float(took) < 0.1
