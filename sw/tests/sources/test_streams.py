# SPDX-License-Identifier: Apache-2.0
"""Streams over the loopback interface: what comes is shown while it is new, what stops is fetched again."""

from __future__ import annotations

import os
import random
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from itertools import pairwise
from pathlib import Path
from threading import Event

import numpy as np
import pytest
from typer.testing import CliRunner

from signum.commands.cli import application
from signum.common.errors import SourceError
from signum.common.urls import without_secrets
from signum.frames.frame import Frame, Source
from signum.sources import stream, udp
from signum.sources.live import LiveSource
from signum.sources.open import open_source
from signum.sources.stream import AvSource

from ..stream import go_first
from . import cameras
from .cameras import HOST, RtspCamera, free_port, mjpeg_camera, running, send

RATE = 60.0


@contextmanager
def taken(source: Source, count: int, within: float = 6.0) -> Iterator[list[Frame]]:
    """The next frames of a source, which is then left."""
    out: list[Frame] = []
    frames, end = iter(source), time.monotonic() + within
    try:
        while len(out) < count:
            assert time.monotonic() < end, f"{len(out)} frames in {within} s"
            out.append(next(frames))
        yield out
    finally:
        frames.close()  # type: ignore[attr-defined]


@pytest.fixture(scope="module")
def film() -> list[bytes]:
    return cameras.encoded(cameras.moving(60), every=10)


def _everything(source: LiveSource, last: int) -> list[Frame]:
    """The frames up to number `last`; on a machine that is busy with other things, some may have been passed over."""
    source.stopping.clear()
    out: list[Frame] = []
    frames = source._arrivals()
    while not out or int(out[-1].name) < last:
        out.append(next(frames))
    source.stopping.set()
    frames.close()  # type: ignore[attr-defined]
    assert len(out) > last / 2
    return out


def test_udp_with_packets_lost_exchanged_and_repeated(film: list[bytes]) -> None:
    """Frames have the time of their own arrival, and are those that were sent."""
    clean, chance = cameras.plainly_decoded(film), random.Random(3)
    sent = [[d for d in parts for _ in range(chance.choice((1, 1, 1, 2)))] for parts in cameras.packets(film, RATE)]
    for parts in sent[1:]:
        chance.shuffle(parts)
    sent[33] = sent[33][:1]
    port = free_port()
    source = open_source(f"udp://{HOST}:{port}")
    assert source.live and isinstance(source, udp.UdpSource)
    with running(send, port, sent, RATE, 0.1):
        frames = _everything(source, 52)
    names = [int(f.name) for f in frames]
    places = [next(k for k, one in enumerate(clean) if np.array_equal(one, f.picture)) for f in frames]
    assert places == [name if name < 33 else name + 7 for name in names], "of frames 33 to 39 nothing is shown"
    times = np.array([f.time_s for f in frames])
    assert (np.diff(times) > 0).all()
    assert np.abs(times - times[0] - (np.array(places) - places[0]) / RATE).max() < 0.1
    assert 0 <= time.monotonic() - times[-1] < 1.0
    assert source.lost > 0


def test_udp_that_pauses_is_told_once_and_comes_back(film: list[bytes], monkeypatch: pytest.MonkeyPatch,
                                                     capsys: pytest.CaptureFixture[str]) -> None:
    """As does another sender, when the camera's program was started again."""
    monkeypatch.setattr(udp, "QUIET_S", 0.3)
    monkeypatch.setattr(stream, "AGAIN_S", 0.05)
    port = free_port()

    def twice(stop: Event) -> None:
        for sender in (1, 2):
            send(stop, port, cameras.packets(film[:20], sender=sender), RATE, 0.1)
            stop.wait(1.0)

    with running(twice):
        _everything(open_source(f"udp://:{port}"), 39)  # type: ignore[arg-type]
    said = capsys.readouterr().err
    assert said.count("stopped after frame 19 (no whole picture for") == 1 and said.count("\n") == 1, said


@pytest.mark.parametrize(("datagram", "says"), [
    (None, "nothing came in.*port"), (b"\x47" * 188, "MPEG transport stream"),
    (b"hello, who is there", "something else"),
    (b"\x80\x60\0\1\0\0\0\1\0\0\0\1\x41xyz", "no whole picture of H.264.*config-interval"),
])
def test_udp_without_a_picture_says_what_came_instead(datagram: bytes | None, says: str,
                                                      monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(udp, "FIRST_S", 0.2)
    port = free_port()
    with running(send, port, [[datagram]] if datagram else [], RATE, 0.05), \
            pytest.raises(SourceError, match=says):
        next(iter(open_source(f"udp://:{port}")))


@pytest.mark.parametrize(("address", "says"), [
    ("udp://5600", "write it as udp://:PORT"), ("udp://:0", "from 1 to 65535"), ("udp://:99999", "from 1 to 65535"),
    ("udp://192.0.2.7:5600", "no address of this computer: udp://:5600"),
    ("udp://no.such.host.invalid:5600", "not known"),
    ("rtsp://127.0.0.1:1/cam", "Connection refused"), ("http://127.0.0.1:1/cam", "Connection refused"),
    ("rtsp://", "cannot be opened"), ("http://no.such.host.invalid/", "cannot be opened"),
    ("/dev/video77", "cannot be opened.*No such file.*ls /dev/video"), ("/dev/null", "a device; expected"),
])
def test_a_bad_address_is_one_line(address: str, says: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(application(), ["hold", "--source", address, "--range", "1", "--out",
                                                str(tmp_path / "o")])
    assert result.exit_code == 1
    line = result.output.strip()
    assert "\n" not in line and line.startswith("signum: ")
    with pytest.raises(SourceError, match=says):
        next(iter(open_source(address)))


def test_a_port_that_another_program_has(tmp_path: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("0.0.0.0", 0))
        with pytest.raises(SourceError, match="another program has the port"):
            next(iter(open_source(f"udp://:{other.getsockname()[1]}")))


@pytest.mark.parametrize(("hang", "says"), [(False, "it ended"), (True, "nothing has come for 0.5 s")])
def test_rtsp_is_fetched_again_when_it_stops(film: list[bytes], hang: bool, says: str, monkeypatch: pytest.MonkeyPatch,
                                             capsys: pytest.CaptureFixture[str]) -> None:
    """FFmpeg keeps for itself what it looks at while it connects; what is shown is what was sent."""
    monkeypatch.setattr(stream, "AGAIN_S", 0.05)
    monkeypatch.setattr(stream, "QUIET_S", 0.5)
    camera = RtspCamera(film[:30], film, rate=RATE, hang=hang)
    clean = cameras.plainly_decoded(film)
    with running(camera), taken(open_source(camera.url), 45) as frames:
        places = [next(k for k, one in enumerate(clean) if np.array_equal(f.picture, one)) for f in frames]
        again = 1 + next(k for k, (a, b) in enumerate(pairwise(places)) if b < a)
        assert places[:again] == sorted(places[:again]) and places[again:] == sorted(places[again:])
        assert places[again - 1] >= 28, "of a picture whose end nothing marks the last is not shown"
        ages = [(f.time_s or 0.0) - camera.sent_at[k] for f, k in zip(frames[1:again], places[1:again], strict=True)]
        assert abs(np.median(ages)) < 0.4 / RATE, "a frame's time is that of its own arrival"
        said = capsys.readouterr().err
        assert said.count("the stream stopped after frame") == said.count("\n") == 1 and f"({says})" in said, said
    assert camera.asked[:4] == ["OPTIONS", "DESCRIBE", "SETUP", "PLAY"] and camera.asked.count("PLAY") == 2


def test_mjpeg_is_fetched_again_when_it_ends(monkeypatch: pytest.MonkeyPatch,
                                             capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(stream, "AGAIN_S", 0.05)
    pictures = cameras.moving(60)
    with mjpeg_camera(pictures[:15], pictures, rate=RATE) as address, taken(open_source(address), 30) as frames:
        shown = [min(range(60), key=lambda k: np.abs(f.picture.astype(int) - pictures[k]).mean()) for f in frames]
        again = shown.index(14) + 1
        assert shown[:again] == sorted(set(shown[:again])) and shown[again:] == sorted(set(shown[again:]))
        assert all(np.abs(f.picture.astype(int) - pictures[k]).mean() < 8 for k, f in zip(shown, frames, strict=True))
        said = capsys.readouterr().err
        assert said.count("the stream stopped after frame") == said.count("\n") == 1, said


def test_a_device_is_read_as_it_comes() -> None:
    """FFmpeg's test picture in place of a camera's driver, which this machine has none of."""
    with taken(AvSource("testsrc=size=96x64:rate=60,realtime", "lavfi"), 20) as frames:
        times = np.array([f.time_s for f in frames])
        assert frames[0].size == (96, 64) and np.median(np.diff(times)) == pytest.approx(1 / 60, abs=0.008)


def test_another_size_of_frame_is_one_line(film: list[bytes], monkeypatch: pytest.MonkeyPatch) -> None:
    """The stream comes back with another resolution, which would change the scale of all that is measured."""
    monkeypatch.setattr(stream, "AGAIN_S", 0.05)
    camera = RtspCamera(film[:30], cameras.encoded(cameras.moving(60, (128, 96))), rate=RATE)
    with running(camera), pytest.raises(SourceError, match=r"is 128x96, frame 0 is 96x64: all frames"):
        for _ in open_source(camera.url):
            pass


def test_slow_work_gets_new_frames_of_a_stream(film: list[bytes]) -> None:
    """Work of three periods: a frame is at most two old when it is given, and what came meanwhile is counted."""
    port = free_port()
    source = open_source(f"udp://:{port}")
    with running(send, port, cameras.packets(film, RATE), RATE, 0.1):
        names = []
        for frame in source:
            names.append(int(frame.name))
            time.sleep(3 / RATE)
            if names[-1] > 50:
                break
    assert source.skipped >= names[-1] + 1 - len(names) > 20
    assert source.oldest_s < 2 / RATE + 0.1, "0.1 s for a busy machine"


@pytest.mark.parametrize("way", ["udp", "rtsp"])
def test_what_waited_while_the_reader_was_held_up_is_passed_over(film: list[bytes], way: str) -> None:
    """For half a second the reader does nothing; the next frame that it gives is new all the same."""
    port, camera = free_port(), RtspCamera(film, rate=RATE) if way == "rtsp" else None
    source = open_source(camera.url if camera else f"udp://{HOST}:{port}")
    assert isinstance(source, LiveSource)
    with running(*((camera,) if camera else (send, port, cameras.packets(film, RATE), RATE, 0.1))):
        frames = source._arrivals()
        before = [next(frames) for _ in range(5)][-1]
        time.sleep(0.5)
        after = next(frames)
        late = (camera.sent_at[-1] if camera else time.monotonic()) - (after.time_s or 0.0)
        source.stopping.set()
        frames.close()  # type: ignore[attr-defined]
    assert late < 0.1 and 0.4 < (after.time_s or 0.0) - (before.time_s or 0.0) < 0.7
    assert source.skipped == int(after.name) - int(before.name) - 1 > 15


def test_passwords_are_not_written(film: list[bytes], tmp_path: Path) -> None:
    assert without_secrets("rtsp://me:pw@h/x?token=a&c=1") == "rtsp://***@h/x?token=***&c=1"
    assert without_secrets("dive@me:1.mp4") == "dive@me:1.mp4"
    camera, out = RtspCamera(film, rate=RATE), tmp_path / "o"
    with running(camera):
        address = camera.url.replace("rtsp://", "rtsp://me:hunter2@")
        result = CliRunner().invoke(application(), ["hold", "--source", address, "--range", "1", "--window", "16",
                                                    "--focal", "100", "--seconds", "1", "--out", str(out)])
    assert "frames skipped" in result.output, result.output
    for text in (result.output, *(p.read_text() for p in out.iterdir() if p.suffix in (".jsonl", ".html", ".csv"))):
        assert "hunter2" not in text


def test_ctrl_c_ends_a_stream_that_hangs(film: list[bytes], tmp_path: Path) -> None:
    """The camera is silent when the run is stopped: within two seconds, and what was measured is there. On a machine
    that is busy with other things, the quickest of three counts."""
    for n in range(3):
        took = _stopped(film, tmp_path / str(n))
        if took < 2.0:
            break
    assert took < 2.0


def _stopped(film: list[bytes], out: Path) -> float:
    """Seconds that a hold takes to end when it is interrupted while its stream hangs."""
    camera, table = RtspCamera(film[:30], rate=30.0, hang=True), out / "hold.csv"
    with running(camera):
        run = subprocess.Popen([sys.executable, "-m", "signum.commands.cli", "hold", "--source", camera.url, "--range",
                                "1", "--focal", "100", "--window", "16", "--out", str(out)],
                               stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
                               env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
                               # A job in the background was started to ignore SIGINT.
                               preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL))
        go_first(run.pid)
        end = time.monotonic() + 15
        while time.monotonic() < end and not (table.exists() and table.read_text().count("\n") > 5):
            time.sleep(0.05)
        time.sleep(1.2)  # the film is over
        began = time.monotonic()
        run.send_signal(signal.SIGINT)
        try:
            _, said = run.communicate(timeout=10)
        finally:
            run.kill()
        took = time.monotonic() - began
    assert run.returncode == 130 and "stopped; what was finished is kept" in said, said
    assert table.read_text().count("\n") > 5 and (took > 1.6 or (out / "report.html").exists())
    return took
