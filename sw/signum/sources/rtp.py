# SPDX-License-Identifier: Apache-2.0
"""H.264 in RTP (RFC 3550, RFC 6184): packets to whole pictures, whatever the network loses, repeats or exchanges.

Packets are put in order in a small window; one that is still missing when the window is full, or has been waited for
`PATIENCE_S`, is given up. Of the packets between two changes of the time stamp a picture is made: single NAL units,
STAP-A and FU-A, which is all that non-interleaved packetisation has. A picture of which a packet is missing is never
given, and the next whole one says that something before it was lost.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

WINDOW = 32
"""Packets that are held while an earlier one is missing."""
PATIENCE_S = 0.05
"""Longest wait for a missing packet, seconds."""
SILENCE_S = 0.5
"""Silence of a sender after which another one is listened to, seconds."""
JUMP = 3000
"""Numbers by which a packet may differ from the one expected; beyond it the sender has begun anew."""
LARGEST = 8 << 20
"""Bytes of a picture; more is damage."""
DYNAMIC = range(96, 128)
"""Payload types without a meaning of their own, of which video takes one."""
START = b"\0\0\0\1"
"""Before a NAL unit in a byte stream (Annex B of H.264)."""
STAP_A, FU_A = 24, 28
"""Types of packets that hold several NAL units, and a part of one."""


@dataclass(frozen=True)
class Packet:
    """An RTP packet.

    Attributes:
        number: 16 bits, one higher than that of the packet before.
        stamp: 32 bits, the picture's time in units of 1/90000 s.
        sender: 32 bits (SSRC).
        kind: payload type.
        last: whether it is marked as the picture's last.
        data: payload.
        came: when it arrived, seconds on the monotonic clock.
    """

    number: int
    stamp: int
    sender: int
    kind: int
    last: bool
    data: bytes
    came: float


@dataclass(frozen=True)
class Unit:
    """The NAL units of one picture as a byte stream.

    Attributes:
        data: begins with a start code.
        stamp: of its packets.
        came: when its last packet arrived, seconds on the monotonic clock.
        gap: whether something before it was lost.
    """

    data: bytes
    stamp: int
    came: float
    gap: bool


def parse(datagram: bytes, came: float) -> Packet | None:
    """The packet in a datagram; None if it is no RTP packet of video."""
    if len(datagram) < 13 or datagram[0] >> 6 != 2 or datagram[1] & 127 not in DYNAMIC:
        return None
    begin, end = 12 + 4 * (datagram[0] & 15), len(datagram)
    if datagram[0] & 16:  # an extension of the header
        if end < begin + 4:
            return None
        begin += 4 + 4 * int.from_bytes(datagram[begin + 2:begin + 4], "big")
    if datagram[0] & 32:  # padding, whose last byte is its length
        end -= datagram[-1]
    if begin >= end:
        return None
    number, stamp, sender = struct.unpack_from(">HII", datagram, 2)
    return Packet(number, stamp, sender, datagram[1] & 127, bool(datagram[1] & 128), datagram[begin:end], came)


class InOrder:
    """Packets of one sender in the order of their numbers, each once.

    Attributes:
        lost: packets given up; whoever counts them may set it back.
        expected: number of the next packet; None before the first.
    """

    def __init__(self) -> None:
        self.lost = 0
        self.expected: int | None = None
        self._held: dict[int, Packet] = {}
        self._sender, self._heard = 0, 0.0
        self._strays = 0

    def __call__(self, packet: Packet) -> Iterator[Packet]:
        """The packets that can be given now that this one has come."""
        if self.expected is None or self._anew(packet):
            yield from self._rest()
            self._sender, self.expected = packet.sender, packet.number
        if packet.sender != self._sender:
            return
        self._heard = packet.came
        ahead = _ahead(packet.number, self.expected)
        if abs(ahead) > JUMP:
            return
        self._strays = 0
        if ahead >= 0:  # else a duplicate, or given up before
            self._held[packet.number] = packet
        yield from self.due(packet.came)

    def due(self, now: float) -> Iterator[Packet]:
        """The packets that can be given at a time on the monotonic clock."""
        while self._held and self.expected is not None:
            if self.expected in self._held:
                packet = self._held.pop(self.expected)
                self.expected = (packet.number + 1) % 65536
                yield packet
            elif len(self._held) >= WINDOW or now - min(p.came for p in self._held.values()) > PATIENCE_S:
                self._skip()
            else:
                return

    def _anew(self, packet: Packet) -> bool:
        """Whether the sender begins anew, or another one takes over."""
        assert self.expected is not None
        if packet.sender != self._sender:
            return packet.came - self._heard > SILENCE_S
        if abs(_ahead(packet.number, self.expected)) <= JUMP:
            return False
        self._strays += 1
        return self._strays > 2  # one may be damaged

    def _skip(self) -> None:
        """Give up what is missing before the first packet that is held."""
        assert self.expected is not None
        expected = self.expected
        first = min(self._held, key=lambda number: _ahead(number, expected))
        self.lost += _ahead(first, expected)
        self.expected = first

    def _rest(self) -> Iterator[Packet]:
        """All packets that are held, before the sender changes."""
        while self._held:
            self._skip()
            yield from self.due(0.0)
        self._strays = 0


def _ahead(number: int, expected: int) -> int:
    """By how much a number of 16 bits is ahead of another: -32768..32767."""
    return (number - expected + 32768) % 65536 - 32768


class Pictures:
    """Whole pictures of packets in order.

    Attributes:
        broken: pictures of which something was missing.
        refused: packets of a kind that is not known, or damaged.
    """

    def __init__(self) -> None:
        self.broken = self.refused = 0
        self._after: tuple[int, int] | None = None
        self._stamp: int | None = None
        self._parts: list[bytes] = []
        self._fragments: list[bytes] | None = None
        self._size, self._came = 0, 0.0
        self._whole, self._open, self._gap = True, False, False

    def __call__(self, packet: Packet) -> Iterator[Unit]:
        """The pictures, none to two, that this packet ends."""
        missing = self._after is not None and (packet.sender, packet.number) != self._after
        self._after = packet.sender, (packet.number + 1) % 65536
        if packet.stamp != self._stamp:
            if self._open:  # no packet was marked as its last; that may be the missing one
                self._whole &= not missing
                yield from self._picture()
            self._gap |= missing
            self._stamp, self._whole = packet.stamp, not missing or _begins(packet.data)
        elif missing:
            self._whole = False
        self._open = True
        if self._size + len(packet.data) > LARGEST or not self._add(packet.data):
            self._whole = False
        self._came = packet.came
        if packet.last:
            yield from self._picture()

    def _picture(self) -> Iterator[Unit]:
        """The picture at hand, if it is whole; else what follows is after a gap."""
        if self._whole and self._fragments is None and self._parts and self._stamp is not None:
            yield Unit(b"".join(self._parts), self._stamp, self._came, self._gap)
            self._gap = False
        else:
            self.broken += 1
            self._gap = True
        self._parts, self._fragments, self._size, self._open = [], None, 0, False

    def _add(self, data: bytes) -> bool:
        """Take in a payload; returns whether it is what may come here."""
        self._size += len(data)
        kind = data[0] & 31
        if kind == FU_A:
            return self._fragment(data)
        self.refused += self._fragments is not None
        whole = self._fragments is None
        self._fragments = None
        if 1 <= kind < STAP_A:
            self._parts += [START, data]
            return whole
        if kind != STAP_A:
            self.refused += 1
            return False
        at = 1
        while at + 2 < len(data):
            length = int.from_bytes(data[at:at + 2], "big")
            if not 0 < length <= len(data) - at - 2:
                self.refused += 1
                return False
            self._parts += [START, data[at + 2:at + 2 + length]]
            at += 2 + length
        return whole

    def _fragment(self, data: bytes) -> bool:
        """Take in a part of a NAL unit; returns whether the parts before it are there."""
        if len(data) < 3:
            self.refused += 1
            return False
        begins, ends = data[1] & 128, data[1] & 64
        whole = bool(begins) == (self._fragments is None)
        if begins:
            self._fragments = [START, bytes([data[0] & 0xE0 | data[1] & 31])]
        if self._fragments is None:
            return False
        self._fragments.append(data[2:])
        if ends:
            self._parts += self._fragments
            self._fragments = None
        return whole


def _begins(data: bytes) -> bool:
    """Whether a payload can be the first of a picture: parameter sets and the like, or its first macroblock."""
    kind, at = data[0] & 31, 1
    if kind == FU_A:
        if len(data) < 3 or not data[1] & 128:
            return False
        kind, at = data[1] & 31, 2
    return kind == STAP_A or 6 <= kind <= 9 or (kind in (1, 5) and len(data) > at and bool(data[at] & 128))
