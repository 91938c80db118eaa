# SPDX-License-Identifier: Apache-2.0
"""Folders of surveys that are damaged: what can be mended is, with one line; what cannot is said with the remedy."""

import json
import random
import shutil
import zlib
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from signum.applications.mosaic.journal import MATCH, Journal, key_of
from signum.applications.mosaic.shelf import find_survey, read_record
from signum.commands.cli import application
from signum.geometry.similarity import Similarity
from signum.measure.registration import Registration

app = application()
NAMES = "0", "海" * 60, "two\nlines", "3"
"""Names of the frames: a number, 60 Chinese characters (180 bytes), a line break."""


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])


def _contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()
            and p.name != "report.html"}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, dict[str, bytes]]:
    """Pictures with odd names, and a survey of them."""
    place = tmp_path_factory.mktemp("made")
    floor = np.asarray(cv2.GaussianBlur(np.random.default_rng(2).integers(0, 256, (300, 160), dtype=np.uint8), (0, 0),
                                        1.5)) * 2
    (place / "in").mkdir()
    for k, name in enumerate(NAMES):
        data = cv2.imencode(".png", floor[40 * k:40 * k + 120])[1].tobytes()
        (place / "in" / f"{name}.png").write_bytes(data)
    result = _run("mosaic", place / "in", "--window", "32", "--out", place / "out")
    assert result.exit_code == 0, result.output
    return place / "in", place / "out", _contents(place / "out")


def test_names_are_data(made: tuple[Path, Path, dict[str, bytes]]) -> None:
    names = sorted(name for name in made[2] if name.startswith("frames/"))
    assert names == [*(f"frames/{k:06d}.png" for k in range(4)), "frames/journal.txt"]
    assert all(name.encode() in made[2]["poses.csv"] for name in NAMES)


def _lines(change: Callable[[list[bytes]], list[bytes]]) -> Callable[[Path], object]:
    def damage(out: Path) -> None:
        path = out / "frames" / "journal.txt"
        path.write_bytes(b"".join(change(path.read_bytes().splitlines(keepends=True))))
    return damage


def _write(name: str, data: bytes) -> Callable[[Path], object]:
    return lambda out: (out / name).write_bytes(data)


def _flip(out: Path) -> None:
    path, rng = out / "frames" / "journal.txt", random.Random(4)
    data = bytearray(path.read_bytes())
    for _ in range(12):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    path.write_bytes(data)


def _older(word: str) -> Callable[[list[bytes]], list[bytes]]:
    """Registrations as an earlier version wrote them, whose numbers meant something else: those of other pairs here."""
    mine = f'["{MATCH}",'.encode()

    def written(rows: list[bytes]) -> list[bytes]:
        links = [json.loads(row.partition(b" ")[2]) for row in rows if mine in row]
        texts = [json.dumps([word, *link[1:5], other[5]]).encode()
                 for link, other in zip(links, links[1:] + links[:1], strict=True)]
        assert links and word != MATCH
        return [*(row for row in rows if mine not in row), *(b"%08x %s\n" % (zlib.crc32(t), t) for t in texts)]

    return written


def _nan(out: Path) -> None:
    path = out / "edges.csv"
    head, first, *rest = path.read_text().splitlines()
    broken = ",".join(["nan" if "." in cell else cell for cell in first.split(",")])
    path.write_text("\n".join([head, broken, *rest]) + "\n")


DAMAGE: dict[str, tuple[Callable[[Path], object], str]] = {
    "bits flipped": (_flip, "damaged rows"),
    "a row lost": (_lines(lambda rows: rows[:4] + rows[5:]), ""),
    "a frame's row lost": (_lines(lambda rows: [row for row in rows if b'["frame",2,' not in row]), ""),
    "rows shuffled": (_lines(lambda rows: random.Random(1).sample(rows, len(rows))), ""),
    "rows twice": (_lines(lambda rows: [*rows, *rows]), ""),
    "registrations without slope": (_lines(_older("pair")), ""),
    "registrations without doubt": (_lines(_older("link")), ""),
    "cut short": (_lines(lambda rows: [b"".join(rows)[:-9]]), ""),
    "text in it": (_lines(lambda rows: [rows[0], b"hello\n", b"\xff\xfe\n", b"00000000 []\n", *rows[1:]]), "3 damaged"),
    "run.json null": (_write("run.json", b"null"), "run.json: cannot be read"),
    "run.json a list": (_write("run.json", b"[1]"), "run.json: cannot be read"),
    "run.json deep": (_write("run.json", b"[" * 100_000), "run.json: cannot be read"),
    "run.json infinite size": (lambda out: (out / "run.json").write_text((out / "run.json").read_text().replace(
        "160", "1e999", 1)), "run.json: cannot be read"),
    "run.json infinite sigma": (lambda out: (out / "run.json").write_text((out / "run.json").read_text().replace(
        "2.5", "Infinity", 1)), "run.json: cannot be read"),
    "run.json names its parent": (lambda out: (out / "run.json").write_text((out / "run.json").read_text().replace(
        '"made": [', '"made": ["..",', 1)), ""),
    "run.json empty": (_write("run.json", b""), "run.json: cannot be read"),
    "run.json names others": (lambda out: (out / "run.json").write_text((out / "run.json").read_text().replace(
        '"poses.csv"', '"../in/0.png"')), ""),
    "edges with NaN": (_nan, "edges.csv: differs"),
    "edges lost": (lambda out: (out / "edges.csv").unlink(), ""),
    "a picture cut": (lambda out: (out / "frames" / "000001.png").write_bytes(b"\x89PNG"), "stored again"),
    "a picture lost": (lambda out: (out / "frames" / "000001.png").unlink(), "stored again"),
    "another picture": (lambda out: shutil.copy(out / "frames/000000.png", out / "frames/000003.png"),
                        "stored again"),
    "a half file": (_write("frames/.part-000002.png", b"\x89PNG"), ""),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_damage_is_mended(kind: str, made: tuple[Path, Path, dict[str, bytes]], tmp_path: Path) -> None:
    source, whole, before = made
    damage, says = DAMAGE[kind]
    out = tmp_path / "out"
    shutil.copytree(whole, out)
    (out / "notes.txt").write_text("mine")
    damage(out)
    result = _run("mosaic", source, "--window", "32", "--out", out)
    assert result.exit_code == 0 and says in result.stderr.replace("\n", " "), result.output
    after = _contents(out)
    assert after.pop("notes.txt") == b"mine"
    same = [name for name in before if name != "frames/journal.txt"]
    assert [name for name in same if after.get(name) != before[name]] == []
    assert (source / "0.png").exists()


def test_what_cannot_be_mended_is_said(made: tuple[Path, Path, dict[str, bytes]], tmp_path: Path) -> None:
    source, whole, _ = made
    out, fewer = tmp_path / "out", tmp_path / "fewer"
    shutil.copytree(whole, out)
    shutil.copytree(source, fewer)
    (fewer / "3.png").unlink()
    (out / "frames" / "000003.png").write_bytes(b"")
    damaged = _contents(out)
    result = _run("mosaic", fewer, "--window", "32", "--resume", "--out", out)
    assert result.exit_code == 0 and "without this frame" in result.stderr
    shutil.rmtree(out)
    shutil.copytree(whole, out)
    (out / "run.json").unlink()
    (out / "frames" / "journal.txt").write_bytes(b"nothing\n")
    damaged = _contents(out)
    result = _run("mosaic", source, "--window", "32", "--out", out)
    assert result.exit_code == 1 and "no survey that can be continued; --anew moves it aside" in result.stderr
    assert _contents(out) == damaged


def test_a_journal_gives_back_every_bit(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "journal.txt")
    record = json.dumps({"source": "s", "size": [4, 3], "stream": False, "window": 8, "sigma": 2, "columns": "auto",
                         "made": [], "finished": False})
    (tmp_path / "run.json").write_text(record)
    run = find_survey(tmp_path)
    assert run is not None and read_record(tmp_path) == (run, False, [])
    journal.begin(run)
    guess = Similarity(complex(1 / 3, -0.0), 2 / 7 + 1e-300j)
    found = Registration(Similarity(np.complex128(1 + 1e-16j), 0.1 + 0.2j), (1 / 3, 2.0), 0.5, 0.25, 3, 4, True, "",
                         True, (np.float64(0.1), 0.7), 1e-9, 5.0)
    for number in range(3):
        journal.frame(number, NAMES[number], number)
    journal.frame(1, NAMES[1], 1, 0.1 + 0.2)
    journal.frame(1, NAMES[1], 1)
    kept = journal.pair(key_of(0, 1, guess, 24), found)
    journal.store(1, 77)
    journal.close()
    back = Journal(journal.path)
    back.read()
    assert back.find(key_of(0, 1, guess, 24)) == kept == found and back.find(key_of(0, 1, None, 24)) is None
    assert back.run == run and back.stored == {1: 77} and not back.dropped and back.times == {1: 0.1 + 0.2}
    assert journal.path.read_bytes().count(b'["frame",1,') == 2, "nothing is written for a frame without a new time"
    assert {name for name, _ in back.frames.values()} == set(NAMES[:3])
