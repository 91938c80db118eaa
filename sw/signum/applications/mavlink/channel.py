# SPDX-License-Identifier: Apache-2.0
"""Ways for bytes to an autopilot and back that say whether they took them: pymavlink's own connections do not."""

from __future__ import annotations

import contextlib
import errno
import os
import select
import socket
import threading
import time
from abc import ABC, abstractmethod
from typing import Any

READ_BYTES = 1 << 16
BACKLOG = 1 << 14
"""Bytes that a stream may owe its receiver; it takes no message more while it owes so many."""
AGAIN_S = 2.0
"""Time between two attempts to open a broken stream again, seconds."""
REOPEN_S = 0.1
"""Longest wait for the answer of a server that is connected to again, seconds."""
CONNECT_S = 5.0
"""Longest wait for the first answer of a TCP server, seconds."""
REFUSAL_S = 0.2
"""Time for which a refusal of the first datagram is waited for, seconds."""
FORGET_S = 30.0
"""Silence after which a partner that found us is no longer answered, if another one speaks, seconds."""
MOST_PARTNERS = 8
"""Partners that are answered at most, the latest."""
SocketAddress = Any


class Channel(ABC):
    """A way for bytes in both directions. Nothing waits after the opening, but for `REOPEN_S` where a broken stream is
    opened again."""

    @abstractmethod
    def write(self, data: bytes) -> bool:
        """Send a message's bytes; whether they were taken, as far as this side can know."""

    @abstractmethod
    def read(self, wait: float) -> bytes:
        """What has arrived, empty for nothing; waits up to `wait` seconds for it."""

    @abstractmethod
    def close(self) -> None:
        """Close it."""

    def refused(self) -> bool:
        """Whether the host has said that nobody listens to what was just sent."""
        return False


class UdpOut(Channel):
    """Datagrams to one address. The socket is connected, so that the host's refusals are heard."""

    def __init__(self, family: int, address: SocketAddress) -> None:
        self._socket, self._refused = socket.socket(family, socket.SOCK_DGRAM), False
        self._lock = threading.Lock()
        """Between sending and asking for the refusal: a reader would be given it instead."""
        try:
            self._socket.connect(address)
        except OSError:
            self._socket.close()
            raise
        self._socket.setblocking(False)

    def write(self, data: bytes) -> bool:
        """Send a datagram; on the same machine a refusal is known at once, from farther it comes with a later one."""
        with self._lock:
            self._error()  # the refusal of an earlier datagram
            try:
                self._socket.send(data)
            except OSError:
                return False
            return not self._error()

    def _error(self) -> bool:
        """Whether the host has sent an error since this was last asked."""
        error = self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        self._refused |= error == errno.ECONNREFUSED
        return error != 0

    def refused(self) -> bool:
        """Wait a moment for the refusal of the first datagram."""
        ready = select.poll()
        ready.register(self._socket, select.POLLERR)
        if not self._refused and ready.poll(1000 * REFUSAL_S):
            self._error()
        return self._refused

    def read(self, wait: float) -> bytes:
        """A datagram."""
        if not select.select([self._socket], [], [], wait)[0]:
            return b""
        with self._lock:
            try:
                return self._socket.recv(READ_BYTES)
            except OSError:
                return b""

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class UdpIn(Channel):
    """Datagrams to whoever sends us any; until then nothing can be sent."""

    def __init__(self, family: int, address: SocketAddress) -> None:
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        try:
            self._socket.bind(address)
        except OSError:
            self._socket.close()
            raise
        self._socket.setblocking(False)
        self._heard: dict[SocketAddress, float] = {}

    def write(self, data: bytes) -> bool:
        """Send to everybody who was heard lately; whether anybody was."""
        heard = dict(self._heard)
        recent = [a for a, at in heard.items() if len(heard) == 1 or time.monotonic() - at < FORGET_S]
        taken = False
        for address in recent:
            with contextlib.suppress(OSError):
                taken |= self._socket.sendto(data, address) == len(data)
        return taken

    def read(self, wait: float) -> bytes:
        """A datagram; its sender is answered from now on."""
        if not select.select([self._socket], [], [], wait)[0]:
            return b""
        try:
            data, address = self._socket.recvfrom(READ_BYTES)
        except OSError:
            return b""
        self._heard[address] = time.monotonic()
        if len(self._heard) > MOST_PARTNERS:
            del self._heard[min(self._heard, key=self._heard.__getitem__)]
        return data

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class Stream(Channel):
    """A stream of bytes, opened again when it breaks; the part of a message that it could not take at once follows
    before the next one, so that no message is cut."""

    def __init__(self) -> None:
        self._owed = b""
        self._open, self._tried = True, 0.0
        self._start(CONNECT_S)

    @abstractmethod
    def _start(self, patience: float) -> None:
        """Open the stream within `patience` seconds; raises an OSError where it cannot be opened."""

    @abstractmethod
    def _push(self, data: bytes) -> int:
        """Hand over bytes without waiting; returns how many."""

    @abstractmethod
    def _pull(self, wait: float) -> bytes | None:
        """What has arrived; None where the other side has closed."""

    def write(self, data: bytes) -> bool:
        """Send a message's bytes, after those that are owed."""
        if not self._alive():
            return False
        if len(self._owed) > BACKLOG:
            data = b""
        self._owed += data
        try:
            self._owed = self._owed[self._push(self._owed):]
        except OSError:
            self._broken()
        return self._open and data != b""

    def read(self, wait: float) -> bytes:
        """What has arrived."""
        if not self._open:
            time.sleep(wait)
            return b""
        try:
            data = self._pull(wait)
        except (OSError, ValueError, TypeError):  # the two last: `write` has closed it meanwhile
            data = None
        if data is None:
            self._broken()
        return data or b""

    def _broken(self) -> None:
        if self._open:
            self._open, self._owed, self._tried = False, b"", time.monotonic()
            self.close()

    def _alive(self) -> bool:
        """Whether the stream is open; a broken one is opened again, if it can be, from time to time."""
        if not self._open and time.monotonic() - self._tried > AGAIN_S:
            self._tried = time.monotonic()
            with contextlib.suppress(OSError):
                self._start(REOPEN_S)
                self._open = True
        return self._open


class Tcp(Stream):
    """A connection to a TCP server."""

    def __init__(self, family: int, address: SocketAddress) -> None:
        self._family, self._address = family, address
        super().__init__()

    def _start(self, patience: float) -> None:
        self._socket = socket.socket(self._family, socket.SOCK_STREAM)
        try:
            self._socket.settimeout(patience)
            self._socket.connect(self._address)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._socket.setblocking(False)
        except OSError:
            self._socket.close()
            raise

    def _push(self, data: bytes) -> int:
        try:
            return self._socket.send(data)
        except BlockingIOError:
            return 0

    def _pull(self, wait: float) -> bytes | None:
        if not select.select([self._socket], [], [], wait)[0]:
            return b""
        return self._socket.recv(READ_BYTES) or None

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()


class Serial(Stream):
    """A serial port.

    Raises:
        ModuleNotFoundError: if pyserial is not installed.
    """

    def __init__(self, device: str, baud: int) -> None:
        import serial

        self._make = serial.Serial
        self._device, self._baud = device, baud
        super().__init__()

    def _start(self, patience: float) -> None:
        self._port = self._make(self._device, self._baud, timeout=0)

    def _push(self, data: bytes) -> int:
        try:
            return os.write(self._port.fileno(), data)  # pyserial's own `write` waits until all is gone
        except BlockingIOError:
            return 0

    def _pull(self, wait: float) -> bytes | None:
        if not select.select([self._port.fileno()], [], [], wait)[0]:
            return b""
        return os.read(self._port.fileno(), READ_BYTES) or None

    def close(self) -> None:
        """Close the port."""
        self._port.close()
