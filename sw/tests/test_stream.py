# SPDX-License-Identifier: Apache-2.0
"""Seven seconds of the ten minutes of `make stream`, small.

They show what would go wrong in minutes: a queue of frames makes the ages grow from the first second on, and a leak of
more than 15 kB a frame exceeds the bound; the sum of the deltas is that of the whole run however long it is.
"""

from __future__ import annotations

from pathlib import Path

from . import stream


def test_a_hold_on_a_stream_keeps_its_bars(tmp_path: Path) -> None:
    done = stream.run(7.0, (320, 240), tmp_path / "hold", "--window", "32")
    missed = [f"{what}: {measured:.2f}, bound {bound:.2f}" for what, measured, bound, kept in done.judge() if not kept]
    assert not missed, missed
    assert len(done.rows) > 100 and "frames skipped" in done.said
    # The camera's sway: 2 x 0.9 x 18 px at 350 px a metre to either side, which the readings follow.
    across = [float(row["y_m"]) for row in done.rows if row["y_m"]]
    assert 0.09 < max(across) - min(across) < 0.1
