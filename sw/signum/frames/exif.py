# SPDX-License-Identifier: Apache-2.0
"""When and where a photograph was taken, by its EXIF tags (CIPA DC-008)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from PIL import ExifTags
from PIL import Image as PilImage


def times_of(files: Sequence[Path]) -> list[float | None]:
    """Seconds since 1970 at which pictures were taken; None for all of them unless every one has a time, and none is
    earlier than the one before. See `taken_at`."""
    times = [taken_at(file) for file in files[:1]]
    if times == [None]:
        return [None] * len(files)
    times += [taken_at(file) for file in files[1:]]
    known = [t for t in times if t is not None]
    return list(times) if len(known) == len(files) and known == sorted(known) else [None] * len(files)


def taken_at(file: Path) -> float | None:
    """Seconds since 1970 at which a picture was taken; None if it does not say.

    The camera's clock is taken for UTC unless the picture states by how much it is ahead of that.
    """
    detail = _tags(file, ExifTags.IFD.Exif)
    text = str(detail.get(ExifTags.Base.DateTimeOriginal, "")).strip("\0 ")
    part = "".join(c for c in str(detail.get(ExifTags.Base.SubsecTimeOriginal, "")) if c.isdigit())
    zone = str(detail.get(ExifTags.Base.OffsetTimeOriginal, "")).strip("\0 ")
    try:
        moment = datetime.strptime(text, "%Y:%m:%d %H:%M:%S").replace(tzinfo=UTC)
        if re.fullmatch(r"[+-]\d\d:\d\d", zone):
            moment = datetime.strptime(f"{text}{zone}", "%Y:%m:%d %H:%M:%S%z")
    except ValueError:
        return None
    return moment.timestamp() + (float(f"0.{part}") if part else 0.0)


def place_of(file: Path) -> tuple[float, float] | None:
    """Latitude and longitude, degrees, north and east positive; None if the picture does not say."""
    gps = _tags(file, ExifTags.IFD.GPSInfo)
    try:
        angles = [_angle(gps[tag]) * (-1 if str(gps[ref]).strip("\0 ").upper() in ("S", "W") else 1) for tag, ref in (
            (ExifTags.GPS.GPSLatitude, ExifTags.GPS.GPSLatitudeRef),
            (ExifTags.GPS.GPSLongitude, ExifTags.GPS.GPSLongitudeRef))]
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        return None
    inside = abs(angles[0]) <= 90 and abs(angles[1]) <= 180  # which NaN is not
    return (angles[0], angles[1]) if inside and any(angles) else None


def _angle(parts: Any) -> float:
    degrees, minutes, seconds = (float(p) for p in parts)
    return degrees + minutes / 60 + seconds / 3600


def _tags(file: Path, which: int) -> dict[int, Any]:
    if not file.is_file():  # a pipe would never open
        return {}
    try:
        with PilImage.open(file) as picture:
            return dict(picture.getexif().get_ifd(which))
    except Exception:  # a broken file makes its reader raise errors of any type; the picture's reader tells of it
        return {}
