# SPDX-License-Identifier: Apache-2.0
"""Where the tools of a build are missing, one line says what to install."""

import shutil
from pathlib import Path

import pytest

from signum import TINY, BoardError, open_board
from sim.board import build

TOOLS = "g++", "make", "perl"


@pytest.mark.parametrize("missing", TOOLS)
def test_a_missing_tool_is_named(missing: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for tool in {*TOOLS, "sh"} - {missing}:
        (tmp_path / tool).symlink_to(str(shutil.which(tool)))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(build, "BUILD", tmp_path / "build")
    with pytest.raises(BoardError) as raised:
        open_board("verilated", TINY)
    said = str(raised.value)
    assert "\n" not in said and f"sudo apt-get install {missing} " in said
