# SPDX-License-Identifier: Apache-2.0
"""What a hold keeps for its report does not grow with its length, and shows what matters all the same."""

from pathlib import Path

import numpy as np

from signum.applications.hold.reading import Reading
from signum.applications.hold.record import CONFIDENCE, MOST_ROWS, HoldRecord

FRAMES = 3 * MOST_ROWS + 5
BLIND = 7 * MOST_ROWS // 3
"""A single frame without a reading."""


def test_a_long_hold_is_kept_in_bounds(tmp_path: Path) -> None:
    record = HoldRecord(tmp_path, truth=False, often=5.0)
    picture, features = np.zeros((12, 16), np.uint8), np.zeros((0, 2))
    for k in range(FRAMES):
        reading = Reading(forward=k * 1e-6, confidence=90) if k != BLIND else Reading()
        record.add(str(k), k / 30, reading, picture, features)
    record.close()
    assert (record.count, record.valid) == (FRAMES, FRAMES - 1)
    series = record.series
    assert MOST_ROWS // 2 <= len(series) <= MOST_ROWS
    assert (np.diff(series[:, 0]) > 0).all() and series[-1, 0] == (FRAMES - 1) / 30
    assert np.diff(series[:, 0]).max() < 8 / 30, "evenly from the beginning to the end"
    assert series[series[:, CONFIDENCE] == 0, 0].tolist() == [BLIND / 30], "the frame without a reading is shown"
    times = [float(caption.split(" s")[0]) for caption, _ in record.shots]
    assert len(times) <= record.most and times[0] == 0 and max(times) > 0.6 * FRAMES / 30
    assert any("lost" in caption for caption, _ in record.shots)
    with (tmp_path / "hold.csv").open() as table:
        assert sum(1 for _ in table) == FRAMES + 1, "the table has every frame"
