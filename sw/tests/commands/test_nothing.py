# SPDX-License-Identifier: Apache-2.0
"""Where nothing is joined or measured the status is not 0, and what was written stays."""

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from signum.commands.cli import application
from signum.common.files import write_picture

from ..report.heads import check_head

SIZE = 192, 144


@pytest.fixture(scope="module")
def unlike(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of pictures that have nothing in common."""
    folder = tmp_path_factory.mktemp("unlike")
    for k in range(3):
        coarse = np.random.default_rng(k).integers(0, 256, (SIZE[1] // 2, SIZE[0] // 2), dtype=np.uint8)
        write_picture(folder / f"{k}.png", coarse.repeat(2, 0).repeat(2, 1))
    return folder


@pytest.mark.parametrize(("command", "table"), [
    (("track", "{in}", "--features", "6", "--window", "32"), "track.csv"),
    (("flow", "{in}", "--window", "32"), "flow.csv"),
    (("stereo", "{in}/0.png", "{in}/1.png", "--step", "32"), "disparity.csv"),
    (("mosaic", "{in}", "--window", "32"), "edges.csv"),
    (("navigate", "{in}/0.png", "{in}/2.png", "--window", "32"), "navigate.csv"),
    (("hold", "--source", "{in}", "--window", "32", "--range", "1", "--focal", "200"), "hold.csv"),
])
def test_nothing_measured(command: tuple[str, ...], table: str, unlike: Path, tmp_path: Path) -> None:
    words = [word.replace("{in}", str(unlike)) for word in command]
    result = CliRunner().invoke(application(), [*words, "--out", str(tmp_path)])
    assert result.exit_code == 1 and "nothing could be measured in" in result.stderr, result.output
    assert len((tmp_path / table).read_text().splitlines()) > 1
    source = {"stereo": f"{unlike}/0.png and {unlike}/1.png", "navigate": f"{unlike}/2.png"}.get(command[0], unlike)
    check_head(tmp_path / "report.html", command[0], str(source))
