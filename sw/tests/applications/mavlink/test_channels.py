# SPDX-License-Identifier: Apache-2.0
"""The ways to an autopilot: each carries messages in both directions, and says what it cannot do on one line."""

from __future__ import annotations

import os
import pty
import socket
import sys
import termios
import time
import tty
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega

from signum.applications.hold.reading import Reading
from signum.applications.mavlink.link import Link
from signum.applications.mavlink.sink import MavlinkSink
from signum.common.errors import SignumError

from .ends import free_port, receiver, soon

OUT, BACK = "VISION_POSITION_DELTA", "ATTITUDE"


def _readings(sink: MavlinkSink, count: int, start: float = 0.0) -> None:
    for k in range(count + 1):
        sink.send(start + 0.1 * k, Reading(0.01 * k, 0.0, 0.0, 1.0, 2.0, 90))


def _both_ways(sink: MavlinkSink, other: Any) -> None:
    """Three deltas arrive there, an attitude arrives here."""
    _readings(sink, 3)
    assert sink.sent == 3 and sink.failed == 0
    assert all(other.recv_match(type=OUT, blocking=True, timeout=5) for _ in range(3))
    other.mav.attitude_send(1000, 0.1, -0.2, 0.3, 0, 0, 0)
    assert soon(lambda: sink.link.vehicle.attitude(time.monotonic()))
    attitude = sink.link.vehicle.attitude(time.monotonic())
    assert attitude is not None and (attitude.roll, attitude.pitch) == pytest.approx((0.1, -0.2))


def test_udp_out() -> None:
    with receiver() as other, MavlinkSink(other.address) as sink:
        other.heard("HEARTBEAT", 1)  # from which the other end knows whom to answer
        _both_ways(sink, other.link)


def test_udp_in_sends_to_whoever_speaks_and_counts_nothing_before() -> None:
    port = free_port()
    with MavlinkSink(f"udpin:127.0.0.1:{port}") as sink:
        _readings(sink, 3)
        assert (sink.sent, sink.failed) == (0, 3)
        other: Any = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=1, source_component=1)
        other.mav.heartbeat_send(12, 3, 0, 0, 4)
        channel: Any = sink.link._channel
        assert soon(lambda: channel._heard)
        sink.send(0.4, Reading(0.04, 0.0, 0.0, 1.0, 2.0, 90))
        got = other.recv_match(type=OUT, blocking=True, timeout=5)
        other.close()
    assert got.position_delta[0] == pytest.approx(0.04), "the whole change since the first reading"
    assert sink.sent == 1


def test_tcp_and_a_server_that_goes_and_comes_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("signum.applications.mavlink.channel.AGAIN_S", 0.0)
    port = free_port(socket.SOCK_STREAM)
    server: Any = mavutil.mavlink_connection(f"tcpin:127.0.0.1:{port}", source_system=1, source_component=1)
    with MavlinkSink(f"tcp:127.0.0.1:{port}") as sink:
        assert soon(lambda: server.recv_match(type="HEARTBEAT"))
        _both_ways(sink, server)
        server.port.close()
        server.listen.close()
        channel: Any = sink.link._channel
        assert soon(lambda: not channel._open)
        before = sink.sent
        _readings(sink, 2, 10.0)
        assert sink.sent == before and sink.failed > 0
        again: Any = mavutil.mavlink_connection(f"tcpin:127.0.0.1:{port}", source_system=1, source_component=1)
        _readings(sink, 2, 10.5)
        assert sink.sent > before
        assert soon(lambda: again.recv_match(type=OUT))
        again.close()


@pytest.fixture
def line() -> Iterator[tuple[int, str]]:
    """The two ends of a serial line: a file descriptor and a device."""
    master, slave = pty.openpty()
    tty.setraw(slave, termios.TCSANOW)
    yield master, os.ttyname(slave)
    os.close(slave)
    os.close(master)


@pytest.mark.parametrize("written", ["serial:{}:57600", "serial:{}", "{}", "{},57600"])
def test_serial(line: tuple[int, str], written: str) -> None:
    master, device = line
    reader = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=1)
    with MavlinkSink(written.format(device)) as sink:
        _readings(sink, 3)
        got: list[Any] = []

        def arrived() -> bool:
            got.extend(m for m in reader.parse_buffer(os.read(master, 4096)) or [] if m.get_type() == OUT)
            return len(got) == 3

        assert soon(arrived) and sink.sent == 3
        os.write(master, reader.attitude_encode(1000, 0.1, -0.2, 0.3, 0, 0, 0).pack(reader))
        assert soon(lambda: sink.link.vehicle.attitude(time.monotonic()))


def test_a_line_that_takes_no_more_is_not_counted_and_cuts_no_message(line: tuple[int, str]) -> None:
    master, device = line
    with MavlinkSink(f"serial:{device}") as sink:
        _readings(sink, 1500)
        assert 0 < sink.sent < 1000 and sink.failed > 400
        reader: Any = ardupilotmega.MAVLink(None)
        got: list[Any] = []
        reader.robust_parsing = True

        def drained() -> bool:
            sink.link._put(sink.link.messages.MAVLink_heartbeat_message(18, 8, 0, 0, 4, 3))  # pushes what is owed
            got.extend(reader.parse_buffer(os.read(master, 1 << 16)) or [])
            return [m.get_type() for m in got].count(OUT) == sink.sent

        assert soon(drained)
    assert not [m for m in got if m.get_type() == "BAD_DATA"]


@pytest.mark.parametrize(("address", "says"), [
    ("udpout:no-such-host.invalid:14550", "host no-such-host.invalid is not known"),
    ("tcp:no-such-host.invalid:5760", "host no-such-host.invalid is not known"),
    ("udpout:127.0.0.1:99999", "a port is a number from 1 to 65535"),
    ("udpout:127.0.0.1:" + 5000 * "9", "a port is a number from 1 to 65535"),
    ("udpout:\udcff:1", "is not known"),
    ("serial:/dev/ttyACM0:" + 5000 * "9", "write it as serial:DEVICE:BAUD"),
    ("udpout:nowhere", "write it as udpout:HOST:PORT"),
    ("nowhere", "write it as udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT or serial:DEVICE:BAUD"),
    ("serial:/dev/ttyACM0:fast", "write it as serial:DEVICE:BAUD"),
    ("serial:/dev/no-such-port", "name a serial port that is free"),
    ("/dev/no-such-port", "name a serial port that is free"),
    ("udpout:255.255.255.255:14550", "mend host and port"),
    ("udpin:203.0.113.9:14550", "choose a free port and an address of this machine")])
def test_an_address_that_cannot_be_is_one_line(address: str, says: str) -> None:
    with pytest.raises(SignumError, match=says) as error:
        MavlinkSink(address)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("kind", "way"), [("udpout", socket.SOCK_DGRAM), ("tcp", socket.SOCK_STREAM)])
def test_a_refused_endpoint_is_one_line(kind: str, way: int) -> None:
    with pytest.raises(SignumError, match=r"[Cc]onnection refused"):
        MavlinkSink(f"{kind}:127.0.0.1:{free_port(way)}")


def test_a_taken_port_is_one_line() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(SignumError, match="choose a free port"):
            MavlinkSink(f"udpin:127.0.0.1:{taken.getsockname()[1]}")


def test_a_serial_port_without_pyserial_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(SignumError, match=r"serial is not installed: .*'signum\[serial\]'"):
        MavlinkSink("serial:/dev/ttyACM0:57600")


def test_a_receiver_that_goes_is_not_counted_and_one_that_comes_again_is_sent_to() -> None:
    with receiver() as other:
        port = other.link.port.getsockname()[1]
        sink = MavlinkSink(other.address)
        _readings(sink, 2)
        assert sink.sent == 2
    with sink:
        _readings(sink, 40, 0.2)
        assert sink.sent <= 3 and sink.failed >= 30, "of one the refusal may come late, under load"
        sent = sink.sent
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as again:
            again.bind(("127.0.0.1", port))
            for k in range(3):
                sink.send(4.3 + 0.1 * k, Reading(0.0, 0.0, 0.0, 1.0, 2.0, 90))
            assert sink.sent >= sent + 2


def _beats(heard: Callable[[], list[Any]]) -> list[float]:
    times: list[float] = []

    def three() -> bool:
        times.extend(time.monotonic() for _ in heard())
        return len(times) >= 3

    assert soon(three, 6)
    return times


def test_a_heartbeat_every_second_while_nothing_is_measured() -> None:
    with receiver() as other, Link(other.address):
        first = other.heard("HEARTBEAT", 1)[0]

        def heard() -> list[Any]:
            got = other.link.recv_match(type="HEARTBEAT")
            return [got] if got else []

        times = _beats(heard)
    assert (first.type, first.autopilot, first.get_srcSystem(), first.get_srcComponent()) == (18, 8, 1, 197)
    assert times[2] - times[0] == pytest.approx(2.0, abs=0.4)


def test_messages_go_out_as_the_system_that_is_heard() -> None:
    with receiver() as other, MavlinkSink(other.address) as sink:
        other.heard("HEARTBEAT", 1)
        other.link.mav.srcSystem = 7
        other.link.mav.heartbeat_send(12, 3, 0, 0, 4)
        assert soon(lambda: sink.link._out.srcSystem == 7)
        _readings(sink, 1)
        assert other.heard(OUT, 1)[0].get_srcSystem() == 7
