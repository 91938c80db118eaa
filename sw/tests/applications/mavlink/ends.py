# SPDX-License-Identifier: Apache-2.0
"""The other end of a link, by pymavlink, on loopback."""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from pymavlink import mavutil


class Receiver:
    """An autopilot's port; `address` reaches it."""

    def __init__(self) -> None:
        self.link: Any = mavutil.mavlink_connection("udpin:127.0.0.1:0", source_system=1, source_component=1)
        self.address = f"udpout:127.0.0.1:{self.link.port.getsockname()[1]}"

    def heard(self, kind: str, count: int) -> list[Any]:
        """The next `count` messages of a kind."""
        got = [self.link.recv_match(type=kind, blocking=True, timeout=5) for _ in range(count)]
        assert all(got), f"only {sum(map(bool, got))} of {count} {kind}"
        return got

    def nothing(self, kind: str) -> bool:
        """Whether no message of a kind is left."""
        return self.link.recv_match(type=kind, blocking=True, timeout=0.05) is None


@contextmanager
def receiver() -> Iterator[Receiver]:
    """A receiver, closed at the end."""
    one = Receiver()
    try:
        yield one
    finally:
        one.link.close()


def free_port(kind: int = socket.SOCK_DGRAM) -> int:
    """A port of the loopback that nobody has."""
    with socket.socket(socket.AF_INET, kind) as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def soon(condition: Any, seconds: float = 5.0) -> bool:
    """Whether a condition becomes true in time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.005)
    return bool(condition())
