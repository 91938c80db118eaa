# SPDX-License-Identifier: Apache-2.0
"""Deltas: what is sent of gaps, that they add up, and that an autopilot is never told of a speed that was not."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from signum.applications.hold.reading import Reading
from signum.applications.mavlink.sink import MavlinkSink
from signum.common.errors import SignumError

from .ekf import HEALTHY_MS, RECKON_MS, ExternalNav
from .ends import receiver

KIND = "VISION_POSITION_DELTA"


def _flown(times: list[float], readings: list[Reading]) -> tuple[MavlinkSink, list[Any]]:
    """A sink after these readings, and the messages that arrived; each has its time of arrival, `at`."""
    with receiver() as other:
        with MavlinkSink(other.address) as sink:
            got: list[Any] = []
            for time, reading in zip(times, readings, strict=True):
                sink.send(time, reading)
                got += other.heard(KIND, sink.sent - len(got))
                for one in got:
                    one.at = getattr(one, "at", time)
        got += other.heard(KIND, sink.sent - len(got))
        got[-1].at = getattr(got[-1], "at", times[-1] + 1)
        assert other.nothing(KIND)
    return sink, got


def test_deltas_are_received() -> None:
    path = [Reading(0.1 * k, -0.05 * k, 0.0, 1.0, 2.0 - 0.01 * k, 90) for k in range(4)] + [Reading()]
    sink, got = _flown([0.1 * k for k in range(5)], path)
    assert sink.sent == 3, "nothing of the reading that is not valid"
    assert [g.time_usec for g in got] == [100000, 200000, 300000]
    assert got[0].time_delta_usec == 100000
    assert got[0].position_delta == pytest.approx([0.1, -0.05, 0.01], abs=1e-6)
    assert got[0].confidence == 90 and got[0].get_srcComponent() == 197


def _summed(got: list[Any], heading: float) -> list[float]:
    """Position and heading by the autopilot's integration, from the first reading's heading."""
    place = [0.0, 0.0, heading]
    for g in got:
        c, s = math.cos(place[2]), math.sin(place[2])
        place[0] += c * g.position_delta[0] - s * g.position_delta[1]
        place[1] += s * g.position_delta[0] + c * g.position_delta[1]
        place[2] += g.angle_delta[2]
    return place


@pytest.mark.parametrize(("blind", "gaps"), [(0.4, 0), (2.0, 1)])
def test_deltas_lose_no_change_over_a_gap_and_name_what_they_do_not_send(blind: float, gaps: int) -> None:
    """At 30 frames a second; the vehicle turns and moves while nothing is seen."""
    path = [Reading(0.02 * k, -0.01 * k, 0.03 * k, 1.0, 2.0, 90) for k in range(40)]
    times = [k / 30 + (blind if k >= 20 else 0.0) for k in range(40)]
    sent = [*zip(times[:20], path[:20], strict=True),
            *((times[19] + blind * k / 4, Reading()) for k in range(1, 4)), *zip(times[20:], path[20:], strict=True)]
    sink, got = _flown([t for t, _ in sent], [r for _, r in sent])
    assert all(g.confidence == 90 for g in got) and sink.gaps == gaps
    assert (f"{gaps} gaps of over 1 s not sent" in sink.said) == bool(gaps)
    after = next(g for g in got if g.time_usec > 1e6 * (times[19] + 1e-3))
    if not gaps:
        assert after.time_delta_usec == round(1e6 * (times[20] - times[19]))
        assert after.angle_delta[2] == pytest.approx(0.03)
        assert not sink.lost.any()
    else:
        assert sink.lost == pytest.approx([0.02, -0.01, 0.03])
        assert after.time_delta_usec < 150000
    held = _summed(got[:next(k for k, g in enumerate(got) if g is after)], 0.0)
    assert held == pytest.approx([path[19].forward, path[19].right, path[19].heading], abs=1e-5)
    rest = [held[k] + sink.lost[k] for k in range(3)]
    there = _summed(got[got.index(after):], rest[2])
    assert [rest[0] + there[0], rest[1] + there[1], there[2]] == pytest.approx(
        [path[-1].forward, path[-1].right, path[-1].heading], abs=1e-5)


@pytest.mark.parametrize("rate", [9.0, 25.0, 60.0])
def test_an_autopilot_is_told_of_true_speeds_only_and_takes_every_delta(rate: float) -> None:
    """A vehicle that swings by 0.3 m in 8 s; nothing is seen from 2.02 to 2.7 s, at 60 Hz two frames
    after a message, and from 4 to 6.5 s."""
    def place(t: float) -> float:
        return 0.3 * math.sin(2 * math.pi * t / 8)

    def blind(t: float) -> bool:
        return 2.02 <= t < 2.7 or 4 <= t < 6.5

    times = [k / rate for k in range(round(9 * rate))]
    seen = [Reading() if blind(t) else Reading(place(t), 0.5 * place(t), 0.0, 1.0, 2.0, 70) for t in times]
    _, got = _flown(times, seen)
    filter_ = ExternalNav()
    for message in got:
        filter_.take(message, message.at)
    assert not filter_.dropped and filter_.starts and len(filter_.speeds) > 40
    for now, over, forward, right, error in filter_.speeds:
        true = (place(now) - place(now - over)) / over
        assert (forward, right) == pytest.approx((true, 0.5 * true), abs=1e-3)
        assert 1e3 * over <= RECKON_MS and error == pytest.approx(0.34)
    ends = filter_.pauses([s[0] for s in filter_.speeds], HEALTHY_MS)
    assert [round(e, 1) for e in ends] == [pytest.approx(2.7, abs=0.15), pytest.approx(6.6, abs=0.15)]


def test_deltas_keep_ten_a_second_whatever_the_frame_rate() -> None:
    sink, got = _flown([k / 25 for k in range(76)], [Reading(0.01 * k, 0.0, 0.0, 1.0, 2.0, 80) for k in range(76)])
    assert 29 <= sink.sent <= 31
    assert sum(g.position_delta[0] for g in got) == pytest.approx(0.01 * 25 * got[-1].time_usec / 1e6, abs=1e-5)
    assert np.diff([g.time_usec for g in got]).max() <= 120000


@pytest.mark.parametrize("dead", [0.5, 3.0])
def test_what_the_link_does_not_take_is_not_counted_and_not_lost(dead: float, monkeypatch: pytest.MonkeyPatch) -> None:
    with receiver() as other:
        with MavlinkSink(other.address) as sink:
            take = sink.link._channel.write
            for k in range(60):
                refused = 1.0 <= k / 10 < 1.0 + dead
                monkeypatch.setattr(sink.link._channel, "write", (lambda data: False) if refused else take)
                sink.send(k / 10, Reading(0.01 * k, 0.0, 0.0, 1.0, 2.0, 80))
        got = other.heard(KIND, sink.sent)
        assert other.nothing(KIND)
    assert sink.failed >= 10 * dead - sink.gaps - 1 and sink.sent == len(got)
    assert (sink.gaps > 0) == (dead > 1) and f"{sink.failed} could not be sent" in sink.said
    assert sum(g.position_delta[0] for g in got) + sink.lost[0] == pytest.approx(0.59, abs=1e-5)
    assert max(g.time_delta_usec for g in got) <= 1.1e6


def test_an_unknown_message_is_one_line() -> None:
    with pytest.raises(SignumError, match="--message pose: choose one of delta, estimate, odometry"):
        MavlinkSink("udpout:127.0.0.1:14550", message="pose")
