# SPDX-License-Identifier: Apache-2.0
"""Commands that send over MAVLink, with pymavlink at the other end."""

from __future__ import annotations

import csv
import math
import re
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from signum.commands.cli import application
from signum.frames.frame import Frame
from signum.geometry.camera import LOOK_DOWN, Sight
from signum.sources.live import LiveSource
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.vehicle import DOWN, Vehicle
from signum.world.world import World

from ..applications.mavlink.ekf import ExternalNav
from ..applications.mavlink.ends import Receiver, receiver

app = application()
SMALL = Pinhole((192, 144), 200.0)


def _run(*arguments: str | Path | float) -> Result:
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


def test_the_deltas_of_a_run_add_up_to_its_last_reading(tmp_path: Path) -> None:
    """The view stands, is hidden while the vehicle goes to the right, and stands there."""
    rng = np.random.default_rng(6)
    floor, hidden = (np.clip(cv2.GaussianBlur(rng.normal(128, 120, (144, 240)), (0, 0), 2.5), 0, 255).astype(np.uint8)
                     for _ in range(2))
    film = [floor[:, (0 if k < 5 else 24):][:, :192] for k in range(16)]
    film[5:7] = hidden[:, :192], hidden[:, 24:216]
    np.save(tmp_path / "film.npy", np.stack(film))
    with receiver() as other:
        result = _run("hold", "--source", tmp_path / "film.npy", "--range", "1", "--focal", "200", "--window", "32",
                      "--mavlink", other.address, "--out", tmp_path / "out")
        assert result.exit_code == 0 and "gaps" not in result.output, result.output
        rows = _rows(tmp_path / "out" / "hold.csv")
        assert not int(rows[5]["confidence"]) and int(rows[-1]["confidence"])
        count = int(re.findall(r"(\d+) MAVLink messages", " ".join(result.output.split()))[0])
        got = other.heard("VISION_POSITION_DELTA", count)
        assert other.nothing("VISION_POSITION_DELTA")
    assert float(rows[-1]["y_m"]) == pytest.approx(24 / 200, abs=0.002)
    assert sum(g.position_delta[1] for g in got) == pytest.approx(float(rows[-1]["y_m"]), abs=1e-4)
    assert min(g.confidence for g in got) > 0 and max(g.time_delta_usec for g in got) > 100000


FRAMES, RATE = 12, 10.0
YAW = 1.2
"""Of the vehicle at the station, radians."""


def _swing(t: float) -> tuple[float, float, float]:
    """Roll, pitch and yaw of a vehicle that stands still and rocks; level while the run begins."""
    return 0.06 * math.sin(3 * t), 0.04 * math.sin(2.5 * t), YAW + 0.05 * math.sin(2 * t)


@pytest.fixture(scope="module")
def rocking() -> list[np.ndarray]:
    """What its camera sees, 2 m above the floor."""
    world = World(Seafloor(extent=3.0, texel=0.005))
    pictures = []
    for k in range(FRAMES):
        roll, pitch, yaw = _swing(k / RATE)
        vehicle = Vehicle(position=np.array([0.0, 0.0, -2.0]), attitude=np.array([roll, pitch, yaw - YAW]))
        pictures.append(world.look(SMALL, DOWN.sight(vehicle)).frame)
    return pictures


@dataclass
class Told:
    """Between a vehicle and its test: the monotonic time of the first frame, and the poses that arrived."""

    began: float = math.inf
    poses: list[Any] = field(default_factory=list)


@contextmanager
def _telling(other: Receiver, attitude: Callable[[float], tuple[float, float, float]], range_m: float | None
             ) -> Iterator[Told]:
    """An autopilot that sends ATTITUDE at 50 Hz, TIMESYNC answers and perhaps ranges; `attitude` of the time since the
    first frame."""
    stop, told = threading.Event(), Told()

    def tell() -> None:
        other.link.recv_match(type="HEARTBEAT", blocking=True, timeout=20)
        while not stop.wait(0.02):
            now = time.monotonic()
            while (one := other.link.recv_msg()) is not None:
                if one.get_type() == "TIMESYNC" and one.tc1 == 0:
                    other.link.mav.timesync_send(time.monotonic_ns() + 10**12, one.ts1)
                elif one.get_type() == "VISION_POSITION_ESTIMATE":
                    told.poses.append(one)
            t = max(0.0, now - told.began)
            angles, later = attitude(t), attitude(t + 1e-4)
            rates = [(b - a) / 1e-4 for a, b in zip(angles, later, strict=True)]
            other.link.mav.attitude_send(round(1e3 * (now + 1000)), *angles, *rates)
            if range_m is not None:
                other.link.mav.distance_sensor_send(0, 20, 5000, round(100 * range_m), 0, 0, 25, 255)

    thread = threading.Thread(target=tell)
    thread.start()
    try:
        yield told
    finally:
        stop.set()
        thread.join()


@pytest.mark.parametrize("sense", [True, False])
def test_hold_levels_by_the_attitude_that_it_is_told(tmp_path: Path, rocking: list[np.ndarray], sense: bool,
                                                     monkeypatch: pytest.MonkeyPatch) -> None:
    from signum.commands.autopilot import Autopilot

    np.save(tmp_path / "film.npy", np.stack(rocking))
    with receiver() as other, _telling(other, _swing, 2.0 if sense else None) as told:
        begin = Autopilot.begin

        def noted(self: Autopilot, first: float | None) -> None:
            begin(self, first)
            told.began = self._start

        monkeypatch.setattr(Autopilot, "begin", noted)
        result = _run("hold", "--source", tmp_path / "film.npy", "--rate", RATE, "--focal", "200", "--mavlink",
                      other.address, "--message", "estimate", "--window", "32", "--out", tmp_path / "out",
                      *(("--sense",) if sense else ("--range", "2")))
    assert result.exit_code == 0, result.output
    assert ("2.00 m by the vehicle's range finder" in result.output) == sense
    assert (f"attitude known of {FRAMES} of {FRAMES} frames" in " ".join(result.output.split())) == sense
    rows = [r for r in _rows(tmp_path / "out" / "hold.csv") if int(r["confidence"])]
    assert len(rows) > 8
    off = max(math.hypot(float(r["x_m"]), float(r["y_m"])) for r in rows)
    assert off < 0.03 if sense else off > 0.08, "2 m below, 0.06 rad appear as 12 cm"


class _Camera(LiveSource):
    """Gives frames at `RATE` by the clock."""

    def __init__(self, pictures: list[np.ndarray]) -> None:
        super().__init__("camera")
        self._pictures = pictures

    def _arrivals(self) -> Iterator[Frame]:
        start = time.monotonic()
        for k, picture in enumerate(self._pictures):
            self.stopping.wait(max(0.0, start + k / RATE - time.monotonic()))
            yield Frame(str(k), picture, time.monotonic())


def test_a_live_source_is_levelled_by_itself_and_told_in_the_autopilots_time(
        tmp_path: Path, rocking: list[np.ndarray], monkeypatch: pytest.MonkeyPatch) -> None:
    from signum.commands import session

    monkeypatch.setattr(session, "open_source", lambda *_: _Camera(rocking))
    with receiver() as other, _telling(other, lambda t: (0.06, 0.0, YAW), 1.5) as told:
        before = time.monotonic() + 1000
        result = _run("hold", "--source", "0", "--focal", "200", "--mavlink", other.address, "--message", "estimate",
                      "--window", "32", "--out", tmp_path)
        assert result.exit_code == 0, result.output
        after = time.monotonic() + 1000
    assert "1.50 m by the vehicle's range finder" in result.output
    first = told.poses[0]
    assert before < first.usec / 1e6 < after
    assert first.roll == pytest.approx(0.06, abs=1e-3) and first.yaw == pytest.approx(YAW, abs=0.01)


def test_hold_with_sense_alone_is_one_line(tmp_path: Path) -> None:
    result = _run("hold", "--sense", "--out", tmp_path)
    assert result.exit_code == 1 and "--sense belongs to a --source and to --mavlink" in result.output


def test_flow_is_told_in_radians_a_second_by_mavlinks_signs(tmp_path: Path) -> None:
    """6 cm/s ahead and 3 cm/s to the right, 2 m above the floor, at 10 frames a second."""
    world = World(Seafloor(extent=3.0, texel=0.005))
    film = [world.look(SMALL, Sight(np.array([0.006 * k, 0.003 * k, -2.0]), LOOK_DOWN)).frame for k in range(8)]
    film[5] = np.full_like(film[5], 90)
    np.save(tmp_path / "film.npy", np.stack(film))
    with receiver() as other:
        result = _run("flow", tmp_path / "film.npy", "--focal", "200", "--rate", "10", "--window", "32", "--mavlink",
                      other.address, "--out", tmp_path / "out")
        assert result.exit_code == 0 and "5 MAVLink messages" in result.output, result.output
        got = other.heard("OPTICAL_FLOW", 5)
    assert [g.time_usec for g in got] == [100000, 200000, 300000, 400000, 700000], "none of the frame without texture"
    filter_ = ExternalNav()
    taken = [filter_.flow(g) for g in got]
    assert taken[0] is None and None not in taken[1:]
    assert [g.flow_rate_y for g in got] == pytest.approx([0.03] * 5, abs=0.004), "ahead is positive about y"
    assert [g.flow_rate_x for g in got] == pytest.approx([-0.015] * 5, abs=0.004), "to the right is negative about x"
    assert all(g.quality > 128 and g.ground_distance < 0 for g in got)


CALIBRATION = """%YAML:1.0
---
image_width: 192
image_height: 144
K1: !!opencv-matrix {{rows: 3, cols: 3, dt: d, data: [{0}]}}
K2: !!opencv-matrix {{rows: 3, cols: 3, dt: d, data: [{0}]}}
D1: !!opencv-matrix {{rows: 1, cols: 5, dt: d, data: [0., 0., 0., 0., 0.]}}
D2: !!opencv-matrix {{rows: 1, cols: 5, dt: d, data: [0., 0., 0., 0., 0.]}}
R: !!opencv-matrix {{rows: 3, cols: 3, dt: d, data: [1., 0., 0., 0., 1., 0., 0., 0., 1.]}}
T: !!opencv-matrix {{rows: 3, cols: 1, dt: d, data: [-0.12, 0., 0.]}}
""".format("200., 0., 95.5, 0., 200., 71.5, 0., 0., 1.")


def test_stereo_tells_the_distance_in_front_of_it(tmp_path: Path) -> None:
    world = World(Seafloor(extent=3.0, texel=0.005))
    heights = 2.0, 1.7, 1.4
    pairs = [world.look_pair(SMALL, Sight(np.array([0.0, 0.0, -h]), LOOK_DOWN), 0.12) for h in heights]
    blank = np.full_like(pairs[0][0].frame, 90)
    for side, name in enumerate(("left", "right")):
        np.save(tmp_path / f"{name}.npy", np.stack([*(p[side].frame for p in pairs), blank]))
    (tmp_path / "rig.yaml").write_text(CALIBRATION)
    with receiver() as other:
        result = _run("stereo", tmp_path / "left.npy", tmp_path / "right.npy", "--calibration", tmp_path / "rig.yaml",
                      "--most", "30", "--step", "16", "--mavlink", other.address, "--out", tmp_path / "out")
        assert result.exit_code == 0 and "3 MAVLink messages" in " ".join(result.output.split()), result.output
        got = other.heard("DISTANCE_SENSOR", 3)
    for shot, told in zip(pairs, got, strict=True):
        assert told.current_distance / 100 == pytest.approx(float(np.median(shot[0].depth[36:108, 48:144])), rel=0.02)
        assert told.min_distance == 80 and told.max_distance == 2400 and told.orientation == 25
        assert 30 < told.signal_quality <= 100 and 1 <= told.covariance <= 4
        assert told.horizontal_fov == pytest.approx(2 * math.atan(48 / 200))
    assert [g.time_boot_ms for g in got] == [0, 100, 200]


def test_stereo_without_a_calibration_has_no_range_to_tell(tmp_path: Path, film: list[np.ndarray]) -> None:
    np.save(tmp_path / "film.npy", np.stack(film))
    result = _run("stereo", tmp_path / "film.npy", tmp_path / "film.npy", "--mavlink", "udpout:127.0.0.1:9", "--out",
                  tmp_path / "out")
    assert result.exit_code == 1 and "without a --calibration there is no range to send" in result.output
