# SPDX-License-Identifier: Apache-2.0
"""Pictures and films are whole or absent, and a failure to write them is an error that names the file."""

from __future__ import annotations

import multiprocessing
import resource
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from signum.applications.mosaic.shelf import read_record
from signum.common.errors import SignumError
from signum.common.files import own_bytes, write_picture
from signum.report.movie import Movie

NOISE = np.random.default_rng(1).integers(0, 256, (120, 160), dtype=np.uint8)


def _film(path: Path) -> None:
    movie = Movie(path)
    for k in range(40):
        movie.write(np.roll(NOISE, 11 * k, 1))
    movie.close()


def _picture(path: Path) -> None:
    write_picture(path, NOISE)


def _limited(make: Callable[[Path], None], path: Path) -> str:
    """What a call says in a process whose files may have 8 kB, as on a full disk."""
    fork = multiprocessing.get_context("fork")
    reading, writing = fork.Pipe(duplex=False)

    def run() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))
        try:
            make(path)
        except (OSError, SignumError) as error:
            writing.send(str(error))
        else:
            writing.send("nothing")

    child = fork.Process(target=run)
    child.start()
    said = str(reading.recv()) if reading.poll(60) else "no answer"
    child.join()
    return said


@pytest.mark.parametrize(("make", "name"), [(_picture, "a.png"), (_film, "a.mp4")])
def test_a_full_disk_is_said(make: Callable[[Path], None], name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    assert str(path) in _limited(make, path)
    assert not path.exists()
    make(path)
    assert path.stat().st_size > 8192 and [p.name for p in tmp_path.iterdir()] == [name]


def test_a_film_holds_every_frame(tmp_path: Path) -> None:
    for picture in (NOISE, np.dstack([NOISE] * 3)[:-1, :-1]):
        movie = Movie(tmp_path / "a.mp4", 25)
        for k in range(5):
            movie.write(np.roll(picture, 9 * k, 1))
        movie.close()
        with av.open(str(tmp_path / "a.mp4")) as film:
            stream = film.streams.video[0]
            assert (stream.codec_context.name, stream.pix_fmt) == ("h264", "yuv420p")
            assert stream.average_rate == Fraction(25)
            frames = [frame.to_ndarray(format="gray") for frame in film.decode(stream)]
        assert len(frames) == 5
        for k, frame in enumerate(frames):
            whole = np.roll(picture, 9 * k, 1)
            grey = whole if whole.ndim == 2 else whole[..., 0]
            assert np.abs(frame.astype(int) - grey[:frame.shape[0], :frame.shape[1]]).mean() < 8


@pytest.mark.parametrize("ending", [".png", ".tif", ".jpg"])
def test_a_pictures_format_is_that_of_its_name(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"\u6f22{ending}"
    write_picture(path, NOISE)
    read = cv2.imdecode(np.frombuffer(path.read_bytes(), np.uint8), cv2.IMREAD_UNCHANGED)
    assert read is not None and read.shape == NOISE.shape and (ending == ".jpg" or np.array_equal(read, NOISE))


def test_an_unknown_format_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"cannot be made a \.xyz file"):
        write_picture(tmp_path / "a.xyz", NOISE)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("target", ["/dev/zero", "/"])
def test_what_is_no_file_is_not_read(tmp_path: Path, target: str) -> None:
    """A device has no end: a survey whose record or picture it replaces takes it for damaged."""
    path = tmp_path / "run.json"
    path.symlink_to(target)
    with pytest.raises(OSError, match="not a file"):
        own_bytes(path)
    assert read_record(tmp_path) is None
