# SPDX-License-Identifier: Apache-2.0
"""Recorded messages by topic: ROS 1 and 2 bags by rosbags, MCAP files of any recorder by the mcap library."""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from mcap.exceptions import EndOfFile
from mcap.reader import SeekingReader
from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

from signum.common.checks import TEXT_BYTES, check_file
from signum.common.errors import SourceError
from signum.sources.checksums import MAGIC, verify_mcap
from signum.sources.wire import FIELDS, from_json, from_protobuf

LARGEST_CHUNK = 1 << 31
"""Largest chunk of an MCAP file that is decompressed, bytes."""
MEND = "`rosbag reindex`, `ros2 bag reindex` or `mcap recover`"


@dataclass
class Topic:
    """A topic of a recording.

    Attributes:
        name, kind: of the topic, and of its messages as ROS 2 writes it ("sensor_msgs/msg/Image") or as Foxglove does.
        count: number of its messages.
    """

    name: str
    kind: str
    count: int = 0


class Log(ABC):
    """An open recording.

    Attributes:
        topics: by name.
        cut: whether its end is missing.
    """

    topics: dict[str, Topic]
    cut = False

    @abstractmethod
    def messages(self, topic: str) -> Iterator[tuple[int, Any]]:
        """Log time in nanoseconds, and the message with its fields as attributes, in order of the log times.

        Raises:
            Exception: of any type, where the file is damaged.
        """


@contextmanager
def opened(path: Path) -> Iterator[Log]:
    """Open a .bag, .db3 or .mcap file, or the folder of a ROS 2 bag.

    Raises:
        SourceError: if it is none, or cannot be read.
    """
    parts = [path]
    if path.is_dir():
        check_file(path / "metadata.yaml", "bag's metadata", SourceError, TEXT_BYTES)
        parts = [part for part in sorted(path.iterdir()) if not part.is_dir() and part.name != "metadata.yaml"]
    for part in parts:
        check_file(part, "bag", SourceError)
        if part.suffix.lower() == ".mcap":
            verify_mcap(part)
    broken = f"{path}: not a ROS bag or MCAP file that can be read"
    if path.suffix.lower() == ".mcap" and not path.is_dir():
        with path.open("rb") as file:
            try:
                log: Log = _McapLog(file)
            except Exception as error:  # of any type, as the file may be anything
                raise SourceError(f"{broken} ({error}); copy it again, or mend it with {MEND}") from error
            yield log
        return
    try:
        reader = AnyReader([path], default_typestore=get_typestore(Stores.LATEST))
        reader.open()
    except Exception as error:  # of any type, from struct.error to those of sqlite
        raise SourceError(f"{broken} ({error}); copy it again, or mend it with {MEND}") from error
    try:
        yield _RosLog(reader)
    finally:
        with suppress(Exception):  # of a damaged bag; what was wrong has been said
            reader.close()


class _RosLog(Log):
    def __init__(self, reader: AnyReader) -> None:
        self._reader = reader
        self.topics = {}
        for c in reader.connections:
            count = c.msgcount if isinstance(c.msgcount, int) else 0  # of a damaged metadata.yaml
            self.topics.setdefault(c.topic, Topic(c.topic, c.msgtype)).count += count

    def messages(self, topic: str) -> Iterator[tuple[int, Any]]:
        chosen = [c for c in self._reader.connections if c.topic == topic]
        for connection, moment, data in self._reader.messages(connections=chosen):
            yield moment, self._reader.deserialize(data, connection.msgtype)


class _McapLog(Log):
    """An MCAP file of any profile, with or without an index; the channels' own encodings are followed."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._size = file.seek(0, io.SEEK_END)
        self._stores: dict[int, Any] = {}
        self._schemas: dict[int, Schema] = {}
        file.seek(0)
        if file.read(len(MAGIC)) != MAGIC:
            raise ValueError("it does not begin as an MCAP file does")
        self.topics = {}
        summary = self._summary()
        if (summary is not None and summary.statistics is not None and summary.chunk_indexes
                and all(c.uncompressed_size <= LARGEST_CHUNK for c in summary.chunk_indexes)):
            self._indexed = True
            self._schemas = dict(summary.schemas)
            for c in summary.channels.values():
                count = summary.statistics.channel_message_counts.get(c.id, 0)
                self._topic(c, summary.schemas.get(c.schema_id)).count += count
            return
        self._indexed = False
        for channel, _ in self._stream():
            self._topic(channel, self._schemas.get(channel.schema_id)).count += 1

    def _summary(self) -> Any:
        self._file.seek(0)
        try:
            return SeekingReader(self._file, validate_crcs=True, record_size_limit=self._size).get_summary()
        except Exception:  # of any type: the file was cut, or has none
            return None

    def _topic(self, channel: Channel, schema: Schema | None) -> Topic:
        parts = (schema.name if schema else "").split("/")
        kind = "/msg/".join(parts) if len(parts) == 2 else "/".join(parts)
        return self.topics.setdefault(channel.topic, Topic(channel.topic, kind))

    def messages(self, topic: str) -> Iterator[tuple[int, Any]]:
        if not self._indexed:
            found = ((c, m) for c, m in self._stream() if c.topic == topic)
        else:
            self._file.seek(0)
            reader = SeekingReader(self._file, validate_crcs=True, record_size_limit=self._size)
            found = ((c, m) for _, c, m in reader.iter_messages(topics=[topic]))
        for channel, message in found:
            yield message.log_time, self._decoded(channel, message.data)

    def _stream(self) -> Iterator[tuple[Channel, Message]]:
        """All messages in the file's order, up to where it was cut."""
        self._file.seek(0)
        channels: dict[int, Channel] = {}
        records = StreamReader(self._file, emit_chunks=True, record_size_limit=self._size).records
        try:
            for record in records:
                inside: list[Any] = [record]
                if isinstance(record, Chunk):
                    if record.uncompressed_size > LARGEST_CHUNK:
                        raise ValueError(f"a chunk of {record.uncompressed_size} bytes")
                    inside = list(breakup_chunk(record, validate_crc=True))
                for one in inside:
                    if isinstance(one, Schema):
                        self._schemas[one.id] = one
                    elif isinstance(one, Channel):
                        channels[one.id] = one
                    elif isinstance(one, Message) and one.channel_id in channels:
                        yield channels[one.channel_id], one
        except EndOfFile:
            self.cut = True

    def _decoded(self, channel: Channel, data: bytes) -> Any:
        schema = self._schemas.get(channel.schema_id)
        name = schema.name if schema else ""
        if channel.message_encoding in ("protobuf", "json"):
            if name not in FIELDS:
                raise ValueError(f"messages {name or 'without a schema'} as {channel.message_encoding}")
            return (from_protobuf if channel.message_encoding == "protobuf" else from_json)(data, name)
        if channel.message_encoding not in ("cdr", "ros1"):
            raise ValueError(f"messages encoded as {channel.message_encoding!r}")
        kind = self._topic(channel, schema).kind
        store = self._store(schema)
        return store.deserialize_ros1(data, kind) if channel.message_encoding == "ros1" else store.deserialize_cdr(
            data, kind)

    def _store(self, schema: Schema | None) -> Any:
        """The types of a schema."""
        known = 0 if schema is None else schema.id
        if known not in self._stores:
            if schema is None or not schema.data:
                self._stores[known] = get_typestore(Stores.LATEST)
            else:
                text = schema.data.decode()
                parts = schema.name.split("/")
                name = "/msg/".join(parts) if len(parts) == 2 else schema.name
                types: dict[str, Any] = {}
                if schema.encoding == "ros2idl":
                    for part in text.split("=" * 80 + "\n"):
                        head, _, body = part.partition("\n")
                        types.update(get_types_from_idl(body if head.startswith("IDL: ") else part)
                                     if part.strip() else {})
                else:
                    types.update(get_types_from_msg(text, name))
                self._stores[known] = get_typestore(Stores.EMPTY)
                self._stores[known].register(types)
        return self._stores[known]
