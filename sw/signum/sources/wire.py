# SPDX-License-Identifier: Apache-2.0
"""Foxglove's messages in Protocol Buffers and JSON, field by field (docs.foxglove.dev/docs/sdk/schemas).

Only the few messages that hold pictures or calibrations are read, so their field numbers stand here instead of a
library that would compile the schema in the file.
"""

from __future__ import annotations

import base64
import json
import struct
from types import SimpleNamespace
from typing import Any

FIELDS: dict[str, dict[int, tuple[str, str]]] = {
    "foxglove.CompressedVideo": {1: ("timestamp", "time"), 2: ("frame_id", "text"), 3: ("data", "bytes"),
                                 4: ("format", "text")},
    "foxglove.CompressedImage": {1: ("timestamp", "time"), 2: ("data", "bytes"), 3: ("format", "text"),
                                 4: ("frame_id", "text")},
    "foxglove.RawImage": {1: ("timestamp", "time"), 2: ("width", "whole"), 3: ("height", "whole"),
                          4: ("encoding", "text"), 5: ("step", "whole"), 6: ("data", "bytes"), 7: ("frame_id", "text")},
    "foxglove.CameraCalibration": {1: ("timestamp", "time"), 2: ("width", "whole"), 3: ("height", "whole"),
                                   4: ("distortion_model", "text"), 5: ("D", "reals"), 6: ("K", "reals"),
                                   7: ("R", "reals"), 8: ("P", "reals"), 9: ("frame_id", "text")}}
"""Message -> number of a field -> its name and kind."""
EMPTY: dict[str, Any] = {"time": None, "text": "", "bytes": b"", "whole": 0, "reals": ()}


def from_protobuf(data: bytes, schema: str) -> SimpleNamespace:
    """A message of one of FIELDS.

    Raises:
        ValueError: if it is broken.
    """
    known = FIELDS[schema]
    out: dict[str, Any] = {name: EMPTY[kind] for name, kind in known.values()}
    for number, value in _fields(data):
        if number not in known:
            continue
        name, kind = known[number]
        if kind == "time" and isinstance(value, bytes):
            parts = dict(_fields(value))
            out[name] = int(parts.get(1, 0)) * 10**9 + int(parts.get(2, 0))
        elif kind == "text" and isinstance(value, bytes):
            out[name] = value.decode()
        elif kind == "reals" and isinstance(value, bytes):
            out[name] = (*out[name], *struct.unpack(f"<{len(value) // 8}d", value[:len(value) // 8 * 8]))
        elif kind in ("bytes", "whole"):
            out[name] = value
    return SimpleNamespace(is_bigendian=0, **out)


def from_json(data: bytes, schema: str) -> SimpleNamespace:
    """A message of one of FIELDS, its bytes as base64.

    Raises:
        ValueError: if it is broken.
    """
    given = json.loads(data)
    out: dict[str, Any] = {}
    for name, kind in FIELDS[schema].values():
        value = given.get(name, EMPTY[kind])
        if kind == "time" and isinstance(value, dict):
            value = int(value.get("sec", 0)) * 10**9 + int(value.get("nsec", 0))
        out[name] = base64.b64decode(value) if kind == "bytes" else value
    return SimpleNamespace(is_bigendian=0, **out)


def _fields(data: bytes) -> list[tuple[int, Any]]:
    """Number and value of every field: whole numbers, or bytes."""
    at = 0
    out: list[tuple[int, Any]] = []
    while at < len(data):
        value: Any
        tag, at = _varint(data, at)
        kind = tag & 7
        if kind == 0:
            value, at = _varint(data, at)
        elif kind in (1, 5):
            size = 8 if kind == 1 else 4
            value, at = data[at:at + size], at + size
        elif kind == 2:
            size, at = _varint(data, at)
            value, at = data[at:at + size], at + size
        else:
            raise ValueError(f"a field of wire type {kind}")
        if at > len(data):
            raise ValueError("the message is cut short")
        out.append((tag >> 3, value))
    return out


def _varint(data: bytes, at: int) -> tuple[int, int]:
    value = 0
    for shift in range(0, 70, 7):
        if at >= len(data):
            raise ValueError("the message is cut short")
        value |= (data[at] & 127) << shift
        at += 1
        if data[at - 1] < 128:
            return value, at
    raise ValueError("a number of more than 64 bits")
