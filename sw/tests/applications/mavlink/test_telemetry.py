# SPDX-License-Identifier: Apache-2.0
"""What the vehicle tells of itself: attitude at a frame's time, range, clock."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as m

from signum.applications.hold.reading import Reading
from signum.applications.mavlink.clock import VehicleClock
from signum.applications.mavlink.sink import MavlinkSink
from signum.applications.mavlink.telemetry import Telemetry

from .ends import receiver, soon

BOOT = 1234.0
"""Autopilot's clock less ours, seconds."""


def _from(message: Any, component: int = 1) -> Any:
    """A message as it is received from a component of the vehicle."""
    message.pack(m.MAVLink(None, srcSystem=1, srcComponent=component))
    return message


def _attitude(boot: float, roll: float, yaw: float = 0.0, rate: float = 0.0) -> Any:
    return _from(m.MAVLink_attitude_message(round(1e3 * boot), roll, -roll, yaw, rate, -rate, 0.5))


def test_an_attitude_is_that_of_the_frames_time_however_late_it_comes() -> None:
    """At 20 Hz, roll 0.1 rad/s, each 5 to 45 ms late; a frame between two of them, and one after the last."""
    vehicle = Telemetry()
    for k in range(21):
        at = k / 20
        vehicle.take(_attitude(BOOT + at, 0.1 * at, math.pi - 0.02 + 0.5 * at, 0.1), at + (0.005, 0.045, 0.02)[k % 3])
    for at in (0.512, 0.93, 1.0, 1.1):
        attitude = vehicle.attitude(at)
        assert attitude is not None
        late = 0.005  # the least of the delays cannot be told from the clocks' difference
        assert attitude.roll == pytest.approx(0.1 * (at - late), abs=2e-4)
        assert attitude.pitch == pytest.approx(-attitude.roll)
        assert math.remainder(attitude.yaw - (math.pi - 0.02 + 0.5 * (at - late)), 2 * math.pi) == pytest.approx(
            0, abs=1e-3)
    assert vehicle.attitude(1.4) is None and vehicle.attitude(-1.0) is None


def test_no_attitude_is_taken_from_others_nor_one_that_is_no_number() -> None:
    vehicle = Telemetry()
    vehicle.take(_from(m.MAVLink_attitude_message(1000, 0.1, 0, 0, 0, 0, 0), component=190), 1.0)
    vehicle.take(_attitude(1.0, math.nan), 1.0)
    assert vehicle.attitude(1.0) is None


def _distance(cm: int, orientation: int = 25, component: int = 1) -> Any:
    return _from(m.MAVLink_distance_sensor_message(0, 20, 5000, cm, 0, 0, orientation, 255), component)


def test_a_range_is_the_median_of_a_second_of_what_looks_down() -> None:
    vehicle = Telemetry()
    assert vehicle.range_m(0.0) is None
    for k, cm in enumerate((150, 152, 900, 148, 151)):
        vehicle.take(_distance(cm), 0.1 * k)
    for odd in (_distance(70, orientation=0), _distance(0), _distance(6000), _distance(70, component=197)):
        vehicle.take(odd, 0.45)
    assert vehicle.range_m(0.5) == pytest.approx(1.51)
    assert vehicle.range_m(1.45) is None, "too old"
    vehicle.take(_from(m.MAVLink_rangefinder_message(2.25, 0.0)), 2.0)
    assert vehicle.range_m(2.1) == pytest.approx(2.25)


def test_the_clock_is_the_best_of_what_was_told() -> None:
    clock = VehicleClock()
    assert clock.offset is None
    for k in range(5):
        clock.arrived(BOOT + k, k + (0.2, 0.03, 0.1)[k % 3])
    assert clock.offset == pytest.approx(BOOT - 0.03)
    clock.answered(5.0, BOOT + 5.05, 5.06)  # 50 ms there, 10 ms back: the half of the trip is wrong by 20 ms
    clock.answered(6.0, BOOT + 6.004, 6.008)
    clock.answered(6.5, BOOT + 6.51, 6.55)
    assert clock.offset == pytest.approx(BOOT)
    clock.answered(0.0, BOOT + 1e6, 1e6)
    clock.answered(9.0, BOOT, 8.0)
    assert clock.offset == pytest.approx(BOOT), "answers to somebody else"
    clock.arrived(3.0, 20.0)
    assert clock.offset == pytest.approx(-17.0), "the autopilot has booted again"


@pytest.mark.parametrize("by", ["TIMESYNC", "SYSTEM_TIME"])
def test_messages_have_the_autopilots_time(by: str) -> None:
    with receiver() as other, MavlinkSink(other.address) as sink:
        asked = other.heard("TIMESYNC", 1)[0]
        boot = BOOT + time.monotonic()
        if by == "TIMESYNC":
            other.link.mav.timesync_send(round(1e9 * boot), asked.ts1)
        else:
            other.link.mav.system_time_send(0, round(1e3 * boot))
        assert soon(lambda: sink.link.vehicle.clock.offset is not None)
        sink.stamp.origin = 1000.0
        for k in range(3):
            sink.send(k / 10, Reading(0.1 * k, 0.0, 0.0, 1.0, 2.0, 90))
        got = other.heard("VISION_POSITION_DELTA", 2)
        assert got[1].time_usec / 1e6 == pytest.approx(1000.2 + BOOT, abs=0.1)
        assert got[1].time_delta_usec == 100000
        other.link.mav.timesync_send(0, 777)
        assert soon(lambda: (answer := other.link.recv_match(type="TIMESYNC")) and answer.ts1 == 777 and answer.tc1 > 0)


def test_a_clock_that_comes_after_the_first_message_is_not_used() -> None:
    with receiver() as other, MavlinkSink(other.address) as sink:
        sink.stamp.origin = 1000.0
        for k in range(4):
            if k == 2:
                sink.link.vehicle.clock.arrived(BOOT, 0.0)
            sink.send(k / 10, Reading(0.1 * k, 0.0, 0.0, 1.0, 2.0, 90))
        assert [g.time_usec for g in other.heard("VISION_POSITION_DELTA", 3)] == [100000, 200000, 300000]


def test_an_autopilot_that_is_silent_is_asked_for_its_attitude_only_where_it_is_wanted() -> None:
    with receiver() as other, MavlinkSink(other.address) as sink:
        other.heard("HEARTBEAT", 1)
        other.link.mav.heartbeat_send(12, 3, 0, 0, 4)
        assert other.nothing("COMMAND_LONG")
        sink.link.asking = True
        other.link.mav.heartbeat_send(12, 3, 0, 0, 4)
        asked = other.heard("COMMAND_LONG", 2)
        assert [(a.command, a.param1, a.param2) for a in asked] == [(511, 30, 50000), (511, 132, 50000)]
        other.link.mav.attitude_send(1000, 0, 0, 0, 0, 0, 0)
        other.link.mav.heartbeat_send(12, 3, 0, 0, 4)
        assert other.nothing("COMMAND_LONG")


def test_whatever_arrives_the_link_goes_on() -> None:
    rng = np.random.default_rng(8)
    good = [bytes(_attitude(1.0, 0.1).get_msgbuf()), bytes(_distance(150).get_msgbuf()),
            bytes(_from(m.MAVLink_statustext_message(6, b"hello")).get_msgbuf())]
    with receiver() as other, MavlinkSink(other.address) as sink:
        other.heard("HEARTBEAT", 1)
        where = next(iter(other.link.clients))
        for k in range(600):
            data = bytearray(good[k % 3])
            for _ in range(int(rng.integers(1, 4))):
                data[int(rng.integers(len(data)))] = int(rng.integers(256))
            other.link.port.sendto(bytes(data[:int(rng.integers(1, len(data) + 1))]), where)
        other.link.port.sendto(b"", where)

        def heard() -> bool:
            """Sent again and again: the receiver's buffer, full of what came before, may drop it."""
            other.link.mav.attitude_send(2000, 0.2, 0, 0, 0, 0, 0)
            attitude = sink.link.vehicle.attitude(time.monotonic())
            return attitude is not None and attitude.roll == pytest.approx(0.2)

        assert soon(heard)
        assert sink.link._thread.is_alive()
