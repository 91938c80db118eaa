# SPDX-License-Identifier: Apache-2.0
"""A host script that imported pymavlink before signum, without a word on MAVLink 2, still sends the message."""

import os
import socket
import subprocess
import sys

import pytest

SCRIPT = """
from pymavlink import mavutil
import sys
from signum import MavlinkSink, Reading
with MavlinkSink(sys.argv[1]) as sink:
    for frame in range(3):
        sink.send(0.1 * frame, Reading(0.25 * frame, 0.0, 0.0, 1.0, 2.0, 90, 9, 12))
    assert sink.sent == 2
"""


@pytest.mark.parametrize("given", [{}, {"MAVLINK20": "1"}, {"MAVLINK09": "1"}, {"MAVLINK_DIALECT": "common"}])
def test_pymavlink_imported_first(given: dict[str, str]) -> None:
    bare = {name: value for name, value in os.environ.items() if not name.startswith("MAVLINK")}
    path = os.pathsep.join(folder for folder in sys.path if folder)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(10)
        subprocess.run([sys.executable, "-c", SCRIPT, f"udpout:127.0.0.1:{receiver.getsockname()[1]}"], check=True,
                       env=bare | {"PYTHONPATH": path} | given)
        kinds: list[int] = []
        while kinds.count(11011) < 2:
            packet = receiver.recv(512)
            assert packet[0] == 0xFD
            kinds.append(int.from_bytes(packet[7:10], "little"))
    assert set(kinds) <= {0, 111, 11011}, "besides HEARTBEAT and TIMESYNC"
