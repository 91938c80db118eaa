# SPDX-License-Identifier: Apache-2.0
"""The demonstration: what it writes, and its figures against the truth."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

from signum.commands.cli import application
from signum.demo import fly
from signum.demo.overview import OVERVIEW_HEIGHT


def test_demo_leaves_everything(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("TRACKED", 6), ("COLUMN_IMAGES", 2), ("HELD_SECONDS", 5.0), ("FREE_SECONDS", 1.0)):
        monkeypatch.setattr(fly, name, value)
    result = CliRunner().invoke(application(), ["demo", "--board", "golden", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    page = (tmp_path / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 18 and "src=" in page
    assert "http" not in re.sub(r"base64,[^\"]*", "", page), "pictures may contain any letters"
    assert np.asarray(cv2.imread(str(tmp_path / "mosaic.png"))).shape[0] > 300
    with (tmp_path / "track.csv").open() as file:
        assert len(list(csv.DictReader(file))) >= 6 * 8
    overview = np.asarray(cv2.imread(str(tmp_path / "overview.png")))
    assert overview.shape[0] == OVERVIEW_HEIGHT and overview.shape[1] > 2 * OVERVIEW_HEIGHT
    figures = re.sub(r"<[^>]+>", " ", page)
    for pattern, bar in ((r"truth, RMS\s+([\d.]+) px", 0.5), (r"last image\s+([\d.]+) px", 1.0),
                         (r"measurement error, RMS\s+([\d.]+) mm", 1.0)):
        found = re.search(pattern, figures)
        assert found and float(found[1]) < bar
