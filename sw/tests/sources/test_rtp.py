# SPDX-License-Identifier: Apache-2.0
"""H.264 in RTP, packets lost, exchanged and repeated: what is given is whole, in order, and never made up."""

from __future__ import annotations

import random
import struct
from collections.abc import Iterable, Sequence

import numpy as np
import pytest

from signum.common.arrays import Image
from signum.sources.decode import picture_of
from signum.sources.rtp import InOrder, Pictures, Unit, parse
from signum.sources.udp import UnitDecoder

from . import cameras

PERIOD_S = 1 / 30


class Receiver:
    """What is behind the port of a UDP source, fed by hand."""

    def __init__(self) -> None:
        self.order, self.pictures = InOrder(), Pictures()

    def units(self, datagrams: Iterable[tuple[float, bytes]]) -> list[Unit]:
        """The pictures of datagrams, each with its time of arrival; those that are waited for included."""
        out, last = [], 0.0
        for came, datagram in datagrams:
            packet, last = parse(datagram, came), came
            out += [unit for one in (self.order(packet) if packet else ()) for unit in self.pictures(one)]
        return out + [unit for one in self.order.due(last + 1.0) for unit in self.pictures(one)]


def _timed(sent: Sequence[Sequence[bytes]]) -> list[tuple[float, bytes]]:
    return [(k * PERIOD_S + 1e-4 * j, datagram) for k, parts in enumerate(sent) for j, datagram in enumerate(parts)]


def _shown(units: Iterable[Unit]) -> list[Image]:
    decoder = UnitDecoder("test")
    return [picture_of(picture, "test") for unit in units for picture in decoder(unit)]


@pytest.fixture(scope="module")
def film() -> list[bytes]:
    """Sixty pictures, a key frame every fifteen, of several packets each."""
    return cameras.encoded(cameras.moving(60), every=15)


@pytest.fixture(scope="module")
def clean(film: list[bytes]) -> list[Image]:
    return cameras.plainly_decoded(film)


def _places(shown: Sequence[Image], clean: Sequence[Image]) -> list[int]:
    """Which picture of the film each one is, bit for bit."""
    places = [next((k for k, one in enumerate(clean) if np.array_equal(one, picture)), -1) for picture in shown]
    assert -1 not in places, "a picture that the camera never saw"
    return places


def test_all_that_is_sent_is_shown_at_once(film: list[bytes], clean: list[Image]) -> None:
    """Numbers and stamps pass their largest value; each picture comes out with its own last packet."""
    receiver, decoder, places = Receiver(), UnitDecoder("test"), []
    for k, parts in enumerate(cameras.packets(film)):
        assert len(parts) > 1
        units = receiver.units((k * PERIOD_S, datagram) for datagram in parts)
        assert len(units) == 1 and not units[0].gap
        places += _places([picture_of(p, "test") for p in decoder(units[0])], clean)
        assert places[-1] == k
    assert len(places) == len(film)


@pytest.mark.parametrize("seed", range(2))
def test_exchanged_and_repeated_packets_change_nothing(film: list[bytes], clean: list[Image], seed: int) -> None:
    """Packets arrive up to ten places late, some of them twice."""
    chance = random.Random(seed)
    datagrams = [d for _, d in _timed(cameras.packets(film))]
    late = [(k + chance.uniform(0, 10) * (k > 0), d) for k, d in enumerate(datagrams)]
    late += [(k + chance.uniform(0, 50), datagrams[k]) for k in chance.sample(range(1, len(datagrams)), 60)]
    units = Receiver().units((k * 0.001, d) for k, (_, d) in enumerate(sorted(late)))
    assert not any(unit.gap for unit in units)
    assert _places(_shown(units), clean) == list(range(len(film)))


@pytest.mark.parametrize("seed", range(4))
def test_after_a_loss_nothing_is_shown_until_a_key_frame(film: list[bytes], clean: list[Image], seed: int) -> None:
    """Three bursts of lost packets, and packets exchanged: the pictures shown are the film's own, in order, and all of
    them from the first key frame after a loss on."""
    chance = random.Random(seed)
    sent = cameras.packets(film)
    datagrams = [(k, d) for k, parts in enumerate(sent) for d in parts]
    lost = set()
    for _ in range(3):
        at = chance.randrange(1, len(datagrams))
        lost |= set(range(at, min(at + chance.choice((1, 1, 2, 12)), len(datagrams))))
    # Of a key frame the parameter sets, its first packet, may be missing: they are those of the one before.
    sets = {datagrams.index((k, sent[k][0])) for k in range(15, 60, 15)}
    broken = {datagrams[k][0] for k in lost - sets}
    kept = [d for k, (_, d) in enumerate(datagrams) if k not in lost]
    order = sorted(range(len(kept)), key=lambda k: k + chance.uniform(0, 3) * (k > 0))
    receiver = Receiver()
    places = _places(_shown(receiver.units((k * 0.002, kept[i]) for k, i in enumerate(order))), clean)
    whole, good = [], False
    for k in range(len(film)):
        good = k not in broken and (good or k % 15 == 0)
        whole += [k] * good
    missed = set(whole) - set(places)
    assert places == sorted(set(places)) and set(places) <= set(whole), (places, whole)
    # A key frame right behind a loss is given only if its own first packet is surely there.
    assert all(k // 15 * 15 - 1 in broken or k // 15 * 15 in broken for k in missed), (missed, broken)
    assert len(places) > len(film) // 5


def test_a_key_frame_without_its_first_slice_is_not_shown() -> None:
    """Slices in packets of their own leave no trace of one that is lost before the first that arrives."""
    film = cameras.encoded(cameras.moving(30, (64, 48)), every=10, more=":slices=3")
    clean, sent = cameras.plainly_decoded(film), cameras.packets(film)
    kinds = [datagram[12] & 31 for datagram in sent[10]]
    assert kinds == [24, 5, 5, 5], "parameter sets and slices"
    sent[10] = sent[10][2:]
    assert _places(_shown(Receiver().units(_timed(sent))), clean) == [*range(10), *range(20, 30)]


def test_intra_refresh_recovers_without_key_frames() -> None:
    """A camera that renews its picture column by column and says so (recovery point) never sends another key frame."""
    film = cameras.encoded(cameras.moving(60), every=15, more=":intra-refresh=1")
    clean = cameras.plainly_decoded(film)
    sent = cameras.packets(film)
    sent[7] = sent[7][1:]
    places = _places(_shown(Receiver().units(_timed(sent))), clean)
    assert places[:7] == list(range(7)) and 7 not in places
    again = next(k for k in places if k > 7)
    assert 16 <= again <= 46 and places[7:] == list(range(again, len(film)))


def test_a_lost_packet_is_waited_for_a_moment_only(film: list[bytes]) -> None:
    sent = _timed(cameras.packets(film))
    del sent[9]
    receiver = Receiver()
    given = [came for came, datagram in sent if _fed(receiver, came, datagram)]
    assert receiver.order.lost == 1 and receiver.pictures.broken == 1
    assert PERIOD_S + 0.01 < np.diff(given).max() < 0.05 + 2 * PERIOD_S


def _fed(receiver: Receiver, came: float, datagram: bytes) -> list[Unit]:
    packet = parse(datagram, came)
    return [unit for one in (receiver.order(packet) if packet else ()) for unit in receiver.pictures(one)]


def test_a_sender_that_begins_anew_is_followed(film: list[bytes], clean: list[Image]) -> None:
    """With other numbers at once, or as another sender after a silence; a second sender beside the first is not."""
    sent = cameras.packets(film[:30])
    anew = cameras.packets(film[30:], number=20_000, stamp=77)
    assert _places(_shown(Receiver().units(_timed([*sent, *anew]))), clean)[-1] == 59
    other = [(2.0 + came, d) for came, d in _timed(cameras.packets(film[30:], sender=9, number=5))]
    places = _places(_shown(Receiver().units([*_timed(sent), *other])), clean)
    assert places == list(range(60))
    beside = sorted([*_timed(sent), *((came + 1e-5, d) for came, d in _timed(cameras.packets(film[30:], sender=9)))])
    assert _places(_shown(Receiver().units(beside)), clean) == list(range(30))


def test_what_is_no_video_is_passed_over(film: list[bytes], clean: list[Image]) -> None:
    chance = random.Random(1)
    junk = [b"", b"\x47" * 188, b"\x80", struct.pack(">BBHII", 128, 96, 1, 2, cameras.SENDER), bytes(12) + b"x",
            struct.pack(">BBHII", 0xB0, 96, 1, 2, 3) + b"\xff\xff\xff\xff\xff"]
    sent = _timed(cameras.packets(film))
    mixed = sorted([*sent, *((chance.uniform(0.0, 2.0), chance.choice(junk)) for _ in range(60))])
    assert _places(_shown(Receiver().units(mixed)), clean) == list(range(60))


@pytest.mark.parametrize("seed", range(3))
def test_whatever_a_packet_holds_memory_is_bounded(seed: int) -> None:
    """Headers of our sender with anything after them: no error, and little is kept."""
    chance = random.Random(seed)
    receiver = Receiver()
    for k in range(3000):
        data = bytes(chance.randrange(256) for _ in range(chance.randrange(1, 12))) + bytes(chance.choice((0, 9000)))
        head = struct.pack(">BBHII", 128, 96, chance.randrange(65536) if k % 7 == 0 else k % 65536, 5, 1)
        _fed(receiver, 0.001 * k, head + data)
        assert len(receiver.order._held) <= 33 and receiver.pictures._size <= 9 << 20


def test_extensions_and_padding_are_no_payload() -> None:
    head = struct.pack(">BBHII", 128 | 16 | 32 | 1, 96, 7, 8, 9) + bytes(4) + struct.pack(">HH", 0xBEDE, 1) + bytes(4)
    packet = parse(head + b"\x65abc" + b"\0\0\3", 0.0)
    assert packet is not None and packet.data == b"\x65abc"
    assert (packet.number, packet.stamp, packet.sender) == (7, 8, 9)
