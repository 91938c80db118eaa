# SPDX-License-Identifier: Apache-2.0
"""Commands that send over MAVLink, with pymavlink at the other end."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from signum.commands.cli import application
from signum.geometry.camera import LOOK_DOWN, Sight
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.world import World

from ..applications.mavlink.ends import receiver

app = application()
SMALL = Pinhole((192, 144), 200.0)


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def film() -> list[np.ndarray]:
    """A camera over a flat floor 2 m below that goes 1 cm ahead a frame."""
    world = World(Seafloor(extent=3.0, texel=0.005))
    return [world.look(SMALL, Sight(np.array([0.01 * k, 0.0, -2.0]), LOOK_DOWN)).frame for k in range(8)]


def test_hold_sends_odometry(tmp_path: Path, film: list[np.ndarray]) -> None:
    np.save(tmp_path / "film.npy", np.stack(film))
    with receiver() as other:
        result = _run("hold", "--source", tmp_path / "film.npy", "--range", "2", "--focal", "200", "--mavlink",
                      other.address, "--message", "odometry", "--out", tmp_path / "out")
        assert result.exit_code == 0 and "8 MAVLink messages;" in result.output, result.output
        got = other.heard("ODOMETRY", 8)
    rows = _rows(tmp_path / "out" / "hold.csv")
    assert [g.x for g in got] == pytest.approx([float(r["x_m"]) for r in rows], abs=1e-5)
    assert [g.quality for g in got] == [int(r["confidence"]) for r in rows]
    assert all(0 < g.pose_covariance[0] < 0.005**2 and g.reset_counter == 0 for g in got)
