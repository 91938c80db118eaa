# SPDX-License-Identifier: Apache-2.0
"""Frames from ROS 1 bags, ROS 2 bags and MCAP files: raw pictures, compressed ones, and video in messages."""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Any

from signum.common.arrays import Image
from signum.common.console import notes
from signum.common.errors import SourceError
from signum.frames.eight import EightBits
from signum.frames.frame import Frame, Source
from signum.sources.decode import MessageDecoder, picture_of
from signum.sources.logs import MEND, Topic, opened
from signum.sources.pixels import compressed_picture, raw_picture

RAW = "sensor_msgs/msg/Image", "foxglove.RawImage", "foxglove_msgs/msg/RawImage"
COMPRESSED = "sensor_msgs/msg/CompressedImage", "foxglove.CompressedImage", "foxglove_msgs/msg/CompressedImage"
VIDEO = ("foxglove.CompressedVideo", "foxglove_msgs/msg/CompressedVideo",
         "ffmpeg_image_transport_msgs/msg/FFMPEGPacket")
AHEAD = 8
"""Messages that are read ahead to put them in order of their stamps."""
NANO = 1e-9
Stamped = tuple[int, int, Any]
"""Nanoseconds, number in the recording, message."""


class BagSource(Source):
    """One image topic of a bag; frames are named by their index from 0, in order of their times.

    A frame's time is its header's stamp, or the time of recording where headers have none.

    Args:
        path: .bag, .mcap, .db3 or the folder of a ROS 2 bag.
        topic: its name; None if the bag has only one image topic.

    Raises:
        SourceError: if it is no bag, has no such image topic, or has several and none is named.
    """

    def __init__(self, path: Path, topic: str | None = None) -> None:
        self.path = path
        with opened(path) as log:
            topics = {name: t for name, t in log.topics.items() if t.kind in (*RAW, *COMPRESSED, *VIDEO)}
            others = sorted(set(log.topics) - set(topics))
        listed = ", ".join(f"{name} ({t.count} frames)" for name, t in topics.items())
        if not topics:
            raise SourceError(f"{path}: no image topic in this bag (it has {', '.join(others) or 'nothing'}); "
                              f"signum reads {RAW[0]}, {COMPRESSED[0]} and {VIDEO[0]}")
        if topic is None and len(topics) > 1:
            raise SourceError(f"{path}: several image topics: {listed}; choose one, e.g. '{path}#{next(iter(topics))}'")
        name = topic or next(iter(topics))
        if name not in topics:
            raise SourceError(f"{path}: no image topic {topic}; it has {listed}")
        self.topic: Topic = topics[name]
        super().__init__(f"{path}#{name}", self.topic.count)

    def _frames(self) -> Iterator[Frame]:
        with opened(self.path) as log:
            eight = EightBits(self.label)
            messages = self._read(log.messages(self.topic.name))
            if self.topic.kind in VIDEO:
                yield from self._video(messages)
            else:
                decode = raw_picture if self.topic.kind in RAW else compressed_picture
                for index, (moment, _, message) in enumerate(_ordered(messages, self.label)):
                    picture: Image = decode(message, f"{self.label}: frame {index}", eight)
                    yield Frame(str(index), picture, moment * NANO)
            if log.cut:
                notes.print(f"{self.label}: the file is cut short; its {self.topic.count} whole frames were read")

    def _read(self, messages: Iterator[tuple[int, Any]]) -> Iterator[Stamped]:
        """Time of recording, number and message, one by one.

        Raises:
            SourceError: where the bag is damaged.
        """
        for index in count():
            try:
                moment, message = next(messages)
            except StopIteration:
                break
            except Exception as error:  # a damaged bag makes its reader raise errors of any type
                raise SourceError(f"{self.label}: broken at frame {index} ({error}); what came before is kept; "
                                  f"mend it with {MEND}") from error
            yield moment, index, message
        if index != self.count:
            raise SourceError(f"{self.label}: the bag lists {self.count} frames, {index} could be read; what was "
                              f"read is kept; mend it with {MEND}")

    def _video(self, messages: Iterator[Stamped]) -> Iterator[Frame]:
        """The pictures of a video, which can be decoded in the order of recording only."""
        decoder: MessageDecoder | None = None
        times: list[int] = []
        done = count()
        for logged, _, message in messages:
            times.append(_stamp(message) or logged)
            decoder = decoder or MessageDecoder(str(getattr(message, "format", None) or message.encoding), self.label)
            for frame in decoder(bytes(message.data)):
                name = str(next(done))
                yield Frame(name, picture_of(frame, f"{self.label}: frame {name}"), times[-1] * NANO)
        for frame in decoder.rest() if decoder else ():
            name = str(next(done))
            yield Frame(name, picture_of(frame, f"{self.label}: frame {name}"), times[-1] * NANO)
        if decoder and decoder.refused:
            notes.print(f"{self.label}: {decoder.refused} of {len(times)} messages gave no picture: they come before "
                        "the first key frame, or are damaged")


def _ordered(messages: Iterator[Stamped], label: str) -> Iterator[Stamped]:
    """The messages in order of their stamps, as far as `AHEAD` of them reach; what is odd is told once."""
    ahead: list[Stamped] = []
    stamped: bool | None = None
    before, latest, late = -1, -1, 0
    waiting: list[Stamped] = []
    for logged, index, message in messages:
        waiting.append((logged, index, message))
        if stamped is None and len(waiting) < 2:
            continue  # a first stamp of 0 may be that of a simulated clock
        if stamped is None:
            stamped = any(_stamp(m) for _, _, m in waiting)
        for when, number, one in waiting:
            moment = _stamp(one) if stamped else when
            late, latest = late + (moment < latest), max(latest, moment)
            heapq.heappush(ahead, (moment, number, one))
        waiting.clear()
        while len(ahead) > AHEAD:
            first = heapq.heappop(ahead)
            before = max(before, first[0])
            yield before, first[1], first[2]
    for when, number, one in waiting:
        heapq.heappush(ahead, (_stamp(one) or when, number, one))
    while ahead:
        first = heapq.heappop(ahead)
        before = max(before, first[0])
        yield before, first[1], first[2]
    if late:
        notes.print(f"{label}: {late} frames were recorded out of the order of their stamps; they were put in order")


def _stamp(message: Any) -> int:
    """Nanoseconds of a message's own time; 0 for none."""
    stamp = message.timestamp if hasattr(message, "timestamp") else getattr(message.header, "stamp", None)
    return int(stamp or 0) if isinstance(stamp, int | None) else int(stamp.sec) * 10**9 + int(stamp.nanosec)
