# SPDX-License-Identifier: Apache-2.0
"""The page of `make compare`, shortened: all methods run and are judged alike; the best are marked, whichever."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from signum.geometry.similarity import Similarity
from tests.compare.__main__ import TASKS, make_page
from tests.compare.mosaics import by_stitcher
from tests.compare.registers import by_features, known_pairs, miss
from tests.compare.table import WATERS, Column, Task
from tests.tracks import Clip

SEED = 5


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Task]]:
    folder = tmp_path_factory.mktemp("compare")
    return folder, {task.name: task for task in make_page(list(TASKS), folder, SEED, quick=True)}


def test_every_method_is_judged_in_both_waters(page: tuple[Path, dict[str, Task]]) -> None:
    folder, tasks = page
    rivals = {"Optical flow": "Signum, pyramidal Lucas-Kanade, DIS, phase correlation",
              "Tracks": "Signum, Lucas-Kanade chain, DIS chain, ORB, SIFT",
              "Registration": "Signum, ORB, SIFT and RANSAC, SIFT after median, phase correlation",
              "Mosaics": "Signum, ORB chain, SIFT chain, phase correlation chain, OpenCV Stitcher",
              "Stereo": "Signum, StereoBM, StereoSGBM"}
    text = (folder / "index.html").read_text()
    assert "make compare" in text or "tests.compare" in text
    assert f"<td>seed</td><td>{SEED}</td>" in text
    for words, names in rivals.items():
        task = next(t for name, t in tasks.items() if name.startswith(words))
        for water in WATERS:
            for method in names.split(", "):
                assert any(m.startswith(method) and w == water for m, w in task.rows), f"{words}: {method}, {water}"
        assert task.name in text
    lines = (folder / "results.csv").read_text().splitlines()
    assert len(lines) == 1 + sum(len(task.columns) * len(task.rows) for task in tasks.values())


def test_signum_is_right_in_murk_and_so_are_others_in_clear_water(page: tuple[Path, dict[str, Task]]) -> None:
    """The judges know right from wrong: methods that are known to work in clear water do."""
    _, tasks = page
    flow = tasks["Optical flow over known shifts"]
    for method in ("Signum", "pyramidal Lucas-Kanade", "DIS"):
        measured, error, far = flow.rows[method, "clear"]
        assert measured > 0.6 and error < 0.1 and far == 0
    assert flow.rows["Signum", "figure 8"][1] < 0.25 < flow.rows["DIS", "figure 8"][1]
    pairs = tasks["Registration of pairs with known motion"]
    for method in ("Signum", "SIFT and RANSAC", "ORB and RANSAC"):
        assert pairs.rows[method, "clear"][:2] == [1.0, 0.0] and pairs.rows[method, "clear"][2] < 1
    tracks = tasks["Tracks of a camera that returns to its start"]
    for method in ("Signum", "Lucas-Kanade chain", "SIFT, matched with the first frame"):
        assert tracks.rows[method, "clear"][1] < 0.5, method
    mosaic = tasks["Mosaics of a survey flown back and forth"]
    for method in ("Signum, all links", "SIFT chain", "OpenCV Stitcher (SCANS)"):
        assert mosaic.rows[method, "clear"][0] == 1 and mosaic.rows[method, "clear"][1] < 3, method
    stereo = tasks["Stereo: rendered floors with boulders"]
    for method in ("Signum", "StereoBM", "StereoSGBM"):
        assert stereo.rows[method, "clear"][0] > 0.5 and stereo.rows[method, "clear"][1] < 0.05, method


def test_the_best_are_marked_whoever_they_are() -> None:
    columns = Column("found", "{:.0%}", "more"), Column("error", "{:.1f}", "less"), Column("size", "{:g}")
    task = Task("a task", columns)
    task.note("Signum", "clear", 0.5, 1.04, 3)
    task.note("another", "clear", 0.9, 1.01, 4)
    task.note("a third", "clear", 0.2, math.nan, 4)
    assert task.best("clear") == [{"another"}, {"Signum", "another"}, set()]
    html = task.html()
    assert "90% *" in html and "50% *" not in html and html.count("1.0 *") == 2


def test_wrong_registrations_count_as_wrong() -> None:
    pair = known_pairs(SEED, 1)[0]
    size = pair.a.shape[1], pair.a.shape[0]
    found = by_features("SIFT")(pair.a, pair.b)
    assert found is not None and miss(found, pair.truth, size) < 1
    assert miss(Similarity(shift=12 + 5j) @ pair.truth, pair.truth, size) == pytest.approx(13)
    assert miss(pair.truth.inverse, pair.truth, size) > 8


def test_the_stitchers_frames_are_placed_where_they_lie() -> None:
    clip = Clip("gravel", SEED, 2)
    whole = clip.frame(0, False)
    frames = [np.ascontiguousarray(whole[y:y + 240, x:x + 320]) for x, y in ((0, 0), (130, 20), (70, 110))]
    placed, picture = by_stitcher(frames)
    assert picture is not None and sorted(placed) == [0, 1, 2]
    apart = placed[1].shift - placed[0].shift, placed[2].shift - placed[0].shift
    assert [complex(a) for a in apart] == pytest.approx([130 + 20j, 70 + 110j], abs=1.5)
