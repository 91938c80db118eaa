# SPDX-License-Identifier: Apache-2.0
"""Seeded damage: edits of a file's bytes, other things in a file's place, names, and values of options."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

Random = np.random.Generator
EXTREMES = tuple(v.to_bytes(8, "little", signed=v < 0) for v in (
    0, 1, -1, 2, 127, 255, 256, 32767, 65535, 2**31 - 1, 2**31, 2**32 - 1, 2**62, 2**63 - 1, -2**31))
WORDS = (b"inf", b"-inf", b"nan", b".nan", b".inf", b"1e308", b"-1e308", b"1e-308", b"0", b"-1", b"-0.0", b"", b"''",
         b"99999999999999999999", b"1,5", b"x", b"=1+1", b"[", b"{", b"null", b"true", b"\xff\xfe", b"\0", b"~", b"&a")
NUMBER = re.compile(rb"-?\d+\.?\d*(?:[eE][+-]?\d+)?")
NAMES = ("=1+1", "-1", "+x", "@x", "[/red]", "[bold]x", ":smile:", "a\nb", "a\tb", "a\rb", " ", "'=x", "x" * 200,
         "\u6f22" * 60, "%d", "%s%n", "{0}", "\x1b[31mred", "..x", "#topic", "a,b", 'q"q', "\udcff\udcfe", "\u202egnp",
         "00", "1e5", "nan", "$(x)", "~", "-")
VALUES = ("inf", "-inf", "nan", "1e308", "-1e308", "0", "-1", "-0.0", "1e-308", "", "x", "1", "2", "3", "7", "8", "16",
          "100", "128", "2147483647", "2147483648", "99999999999999999999", "0.5", "4.0", "1.0", "[/red]", "=1", "../x",
          "\udcff", "x" * 5000, "\u202e")
OPTIONS = {
    "flow": ("--step", "--reach", "--pictures", "--sigma", "--window", "--calibration", "--out", "--board",
             "--megapixels", "--mavlink", "--focal", "--rate"),
    "track": ("--features", "--sigma", "--window", "--calibration", "--out", "--megapixels"),
    "mosaic": ("--range", "--focal", "--epsg", "--navigation", "--start", "--rate", "--truth", "--columns", "--sigma",
               "--window", "--out"),
    "hold --source": ("--range", "--focal", "--rate", "--seconds", "--sigma", "--window", "--calibration", "--mavlink",
                      "--message"),
    "follow --source": ("--rate", "--seconds", "--nearer", "--sigma", "--window", "--calibration", "--right"),
    "stereo": ("--most", "--least", "--step", "--sigma", "--window", "--calibration", "--mavlink", "--rate",
               "--facing"),
    "filter": ("--sigma", "--window", "--out", "--megapixels"),
    "navigate": ("--goto", "--sigma", "--window", "--calibration"),
}
"""Commands, and those of their options that take a value."""


@dataclass(frozen=True)
class Edit:
    """Bytes `start` to `stop` of a file are replaced by others."""

    start: int
    stop: int
    new: bytes

    def __call__(self, raw: bytes) -> bytes:
        return raw[:self.start] + self.new + raw[self.stop:]


def edits(raw: bytes, rng: Random) -> list[Edit]:
    """A few edits of one way: flip, truncate, splice, field or, for a text, number, word or line."""
    text = raw[:4096].isascii() and b"\0" not in raw[:4096]
    way = rng.choice(("number", "number", "number", "line", "flip", "truncate", "splice") if text else
                     ("flip", "flip", "field", "field", "truncate", "splice"))
    count = int(rng.integers(1, 4))
    size = len(raw)
    if way == "truncate":
        return [Edit(int(rng.integers(0, size)), size, b"")]
    if way == "flip":
        return [Edit(at, at + 1, bytes([raw[at] ^ 1 << int(rng.integers(8))])) for at in _places(size, rng, count)]
    if way == "field":
        width = int(rng.choice((1, 2, 4, 8)))
        return [Edit(at, at + width, EXTREMES[int(rng.integers(len(EXTREMES)))][:width])
                for at in _places(size, rng, count)]
    if way == "splice":
        at, source, length = (int(v) for v in rng.integers(0, size, 3))
        block = raw[source:source + min(length, 2000)]
        return [Edit(at, at + (len(block) if rng.integers(2) else 0), block)]
    if way == "line":
        ends = [0, *(m.end() for m in re.finditer(rb"\n", raw)), size]
        k = int(rng.integers(len(ends) - 1))
        line = raw[ends[k]:ends[k + 1]]
        return [Edit(ends[k], ends[k + 1], line * int(rng.choice((0, 2, 3))))]
    found = list(NUMBER.finditer(raw))
    chosen = sorted(set(rng.integers(0, len(found), count).tolist()), reverse=True) if found else []
    return [Edit(found[k].start(), found[k].end(), WORDS[int(rng.integers(len(WORDS)))]) for k in chosen]


def _places(size: int, rng: Random, count: int) -> list[int]:
    """Places in a file, those of heads and tails more often."""
    spans = (0, size), (0, min(size, 300)), (max(0, size - 600), size)
    return [int(rng.integers(*spans[int(rng.integers(3))])) for _ in range(count)]


def replace(path: Path, rng: Random, gone: bool = True) -> str:
    """Put something else in a file's place; returns what. `gone`: whether nothing may be there, which for a picture of
    a folder is no damage."""
    ways = "empty", "pipe", "folder", "zero", "null", "gone", "loop", "locked"
    way = str(rng.choice(ways if gone else [w for w in ways if w != "gone"]))
    raw = path.read_bytes()
    path.unlink()
    if way == "empty":
        path.touch()
    elif way == "pipe":
        os.mkfifo(path)
    elif way == "folder":
        path.mkdir()
    elif way in ("zero", "null"):
        path.symlink_to(f"/dev/{way}")
    elif way == "loop":
        path.symlink_to(path)
    elif way == "locked":
        path.write_bytes(raw)
        path.chmod(0)
    return way


def arguments(rng: Random, source: str, out: str) -> list[str]:
    """A command line with extreme values of options."""
    command = str(rng.choice(list(OPTIONS)))
    name, *flag = command.split()
    out_option = [] if name == "report" else ["--out", out]
    sources = {"stereo": [source, source], "navigate": [f"{source}/../a.png", source], "filter": [f"{source}/../a.png"]}
    line = [name, *flag, *sources.get(name, [source]), *out_option]
    for option in rng.choice(OPTIONS[command], int(rng.integers(1, 3)), replace=False):
        line += [str(option), VALUES[int(rng.integers(len(VALUES)))]]
    return line
