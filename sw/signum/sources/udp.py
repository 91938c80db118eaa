# SPDX-License-Identifier: Apache-2.0
"""Live H.264 in plain RTP that comes to a UDP port, as a BlueROV sends it."""

from __future__ import annotations

import errno
import ipaddress
import re
import socket
import struct
import time
from collections.abc import Iterator
from select import select

import av
from av.video.codeccontext import VideoCodecContext
from av.video.frame import VideoFrame

from signum.common.errors import SourceError
from signum.sources.rtp import InOrder, Pictures, Unit, parse
from signum.sources.stream import QUIET_S, STALE_S, StreamSource, decoded, hurry

FIRST_S = 15.0
"""Longest wait for a first picture, seconds."""
LOOK_S = 0.1
"""How often a reader looks whether it shall stop, seconds."""
DATAGRAM = 65536
BUFFER = 1 << 20
"""Bytes that the system is asked to hold: half a second of a stream of 16 Mbit/s."""
STAMPS = 35
"""Socket option SO_TIMESTAMPNS of Linux, which Python has no name for: the kernel's time of arrival."""
MPEG_TS = b"\x47"
"""First byte of every packet of an MPEG transport stream."""


class UdpSource(StreamSource):
    """H.264 in RTP that comes to a UDP port of this computer, parameter sets in band, as a BlueROV sends it.

    Args:
        address: `udp://:PORT`, or `udp://HOST:PORT` for one address of this computer or a multicast group.

    Raises:
        SourceError: if the address cannot be one.
    """

    def __init__(self, address: str) -> None:
        super().__init__(address)
        found = re.fullmatch(r"(?:udp|rtp)://@?(\[[^\]]*\]|[^:/?#\[\]]*):(\d{1,5})/?", address, re.IGNORECASE)
        if found is None or not 0 < int(found[2]) < 1 << 16:
            raise SourceError(f"{address}: write it as udp://:PORT, with a port from 1 to 65535, as in udp://:5600")
        self.host, self.port = found[1].strip("[]"), int(found[2])

    def _refused(self, reason: str) -> SourceError:
        return SourceError(f"{self.label}: {reason}")

    def _pictures(self) -> Iterator[tuple[float, VideoFrame | None]]:
        with self._listening() as port:
            yield from self._decoded(port)

    def _listening(self) -> socket.socket:
        """The socket.

        Raises:
            OSError: that says how to get it.
        """
        try:
            family, _, _, _, place = socket.getaddrinfo(self.host or "0.0.0.0", self.port, type=socket.SOCK_DGRAM)[0]
        except (OSError, UnicodeError) as error:
            raise OSError(f"host {self.host} is not known; write udp://:{self.port} for any") from error
        port = socket.socket(family, socket.SOCK_DGRAM)
        try:
            group = ipaddress.ip_address(place[0])
            if group.is_multicast:
                port.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            port.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
            port.setsockopt(socket.SOL_SOCKET, STAMPS, 1)
            port.bind(place)
            if group.is_multicast and family == socket.AF_INET:
                port.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group.packed + bytes(4))
            elif group.is_multicast:
                port.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_JOIN_GROUP, group.packed + bytes(4))
            port.settimeout(LOOK_S)
        except OSError as error:
            port.close()
            remedy = {errno.EADDRINUSE: "another program has the port: end it, or have the stream sent to another port",
                      errno.EADDRNOTAVAIL: f"that is no address of this computer: udp://:{self.port} hears all of them",
                      errno.EACCES: "choose a port above 1023"}
            raise OSError(f"{error.strerror}; {remedy.get(error.errno or 0, 'mend the address')}") from error
        return port

    def _decoded(self, port: socket.socket) -> Iterator[tuple[float, VideoFrame | None]]:
        order, pictures, decoder = InOrder(), Pictures(), UnitDecoder(self.label)
        seen, video, last = False, False, b""
        latest = time.monotonic()
        while not self.stopping.is_set():
            try:
                last, came = receive(port)
                packet = parse(last, came)
                video |= packet is not None
                packets = order(packet) if packet else iter(())
            except TimeoutError:
                packets = order.due(time.monotonic())
            for unit in (unit for one in packets for unit in pictures(one)):
                for picture in decoder(unit):
                    seen, latest = True, time.monotonic()
                    stale = time.monotonic() - unit.came > STALE_S and select([port], [], [], 0)[0]
                    yield unit.came, None if stale else picture
            self.lost, order.lost = self.lost + order.lost, 0
            if time.monotonic() - latest > (QUIET_S if seen else FIRST_S):
                raise TimeoutError(f"no whole picture for {QUIET_S:g} s" if seen else self._nothing(video, last))

    def _nothing(self, video: bool, last: bytes) -> str:
        """Why there is no picture."""
        wait = f"in {FIRST_S:.0f} s"
        if not last:
            return (f"nothing came {wait}: have the stream sent to port {self.port} of this computer, and let its "
                    "firewall pass it")
        if video:
            return (f"RTP came, but no whole picture of H.264 {wait}: send H.264 with parameter sets in band and key "
                    "frames (GStreamer: rtph264pay config-interval=1)")
        kind = "an MPEG transport stream" if last.startswith(MPEG_TS) else "something else"
        return f"no RTP came {wait}, but {kind}: send H.264 in RTP (GStreamer: rtph264pay ! udpsink)"


class UnitDecoder:
    """Decodes pictures one by one; after a gap nothing is given until a picture that needs none before it.

    Args:
        label: of the source, for messages.
    """

    def __init__(self, label: str) -> None:
        context = av.CodecContext.create("h264", "r")
        assert isinstance(context, VideoCodecContext)
        self._context, self._label = hurry(context), label
        self._stamp = self._time = 0

    def __call__(self, unit: Unit) -> Iterator[VideoFrame]:
        """The pictures, none or one, that a unit completes."""
        if unit.gap and self._context.is_open:
            self._context.flush_buffers()
        self._time += (unit.stamp - self._stamp + (1 << 31)) % (1 << 32) - (1 << 31)
        self._stamp = unit.stamp
        packet = av.Packet(unit.data)
        packet.pts = packet.dts = self._time
        yield from decoded(self._context, packet, self._label)


def receive(port: socket.socket) -> tuple[bytes, float]:
    """The next datagram, and when it arrived, seconds on the monotonic clock.

    Raises:
        TimeoutError: if none comes in time.
    """
    data, aside, _, _ = port.recvmsg(DATAGRAM, socket.CMSG_SPACE(16))
    now = time.monotonic()
    for level, kind, stamp in aside:
        if level == socket.SOL_SOCKET and kind == STAMPS and len(stamp) == 16:
            seconds, nano = struct.unpack("qq", stamp)
            return data, now - min(max(0.0, time.time() - seconds - 1e-9 * nano), 1.0)  # the clock may be set meanwhile
    return data, now
