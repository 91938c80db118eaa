# SPDX-License-Identifier: Apache-2.0
"""The address of an autopilot: read, its host looked up and its channel opened before anything is measured."""

from __future__ import annotations

import socket
from collections.abc import Callable

from signum.applications.mavlink.channel import Channel, Serial, SocketAddress, Tcp, UdpIn, UdpOut
from signum.common.errors import SignumError, lacking

BAUD = 115200
"""Rate of a serial port where the address names none, bits per second."""
DIGITS = 8
"""Longest number in an address."""
FORMS = "udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT or serial:DEVICE:BAUD"
KINDS: dict[str, Callable[[int, SocketAddress], Channel]] = {"udpout": UdpOut, "udpin": UdpIn, "tcp": Tcp}


def open_channel(address: str) -> Channel:
    """Open the channel of an address.

    Args:
        address: `udpout:HOST:PORT` sends there, `udpin:HOST:PORT` answers whoever sends to that port of ours,
            `tcp:HOST:PORT` connects, `serial:DEVICE:BAUD` or the plain path of a device opens a serial port, of
            `BAUD` bits per second where no rate is given.

    Raises:
        SignumError: if the address is none, its host is not known, or it cannot be opened.
    """
    kind, _, place = address.partition(":")
    if kind == "serial" or address.startswith("/"):
        return _serial(address, place if kind == "serial" else address)
    if kind not in KINDS:
        raise SignumError(f"--mavlink {address}: write it as {FORMS}")
    family, found = _looked_up(address, kind, place)
    try:
        return KINDS[kind](family, found)
    except OSError as error:
        remedy = {"udpin": "choose a free port and an address of this machine",
                  "tcp": "start what listens there first, or mend host and port"}
        raise SignumError(f"--mavlink {address}: {_reason(error)}; {remedy.get(kind, 'mend host and port')}") from error


def _looked_up(address: str, kind: str, place: str) -> tuple[int, SocketAddress]:
    """Family and socket address of `HOST:PORT`."""
    host, _, port = place.rpartition(":")
    if not port.isdecimal() or (not host and kind != "udpin"):
        raise SignumError(f"--mavlink {address}: write it as {kind}:HOST:PORT")
    if len(port) > DIGITS or not 0 < int(port) < 1 << 16:
        raise SignumError(f"--mavlink {address}: a port is a number from 1 to 65535")
    host = host.removeprefix("[").removesuffix("]")
    way = socket.SOCK_STREAM if kind == "tcp" else socket.SOCK_DGRAM
    try:
        found = socket.getaddrinfo(host or "0.0.0.0", int(port), type=way)
    except (OSError, UnicodeError) as error:
        raise SignumError(f"--mavlink {address}: host {host} is not known: {_reason(error)}; give its IP address"
                          ) from error
    first = min(found, key=lambda one: one[0] != socket.AF_INET)  # as most receivers listen to IPv4 alone
    return first[0], first[4]


def _serial(address: str, place: str) -> Channel:
    device, _, baud = place.replace(",", ":").partition(":")
    if not device or (baud and not (baud.isdecimal() and len(baud) <= DIGITS and int(baud) > 0)):
        raise SignumError(f"--mavlink {address}: write it as serial:DEVICE:BAUD, as in serial:/dev/ttyACM0:{BAUD}")
    try:
        return Serial(device, int(baud or BAUD))
    except ModuleNotFoundError as error:
        raise lacking("serial", error) from error
    except (OSError, ValueError) as error:
        raise SignumError(f"--mavlink {address}: {_reason(error)}; name a serial port that is free, and a rate that it "
                          "has") from error


def _reason(error: Exception) -> str:
    """What the system says, on one line."""
    return " ".join(str(getattr(error, "strerror", None) or error).split())
