# SPDX-License-Identifier: Apache-2.0
"""Cameras on the loopback interface: H.264 in RTP by UDP, an RTSP server, and MJPEG over HTTP."""

from __future__ import annotations

import base64
import re
import socket
import struct
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from fractions import Fraction
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Event, Thread
from typing import Any

import av
import cv2
import numpy as np
from av.video.codeccontext import VideoCodecContext

from signum.common.arrays import Image
from signum.sources.decode import picture_of

HOST = "127.0.0.1"
TICKS = 90_000
"""Units of RTP's time stamp in a second."""
MTU = 500
SENDER = 0x51670


def moving(count: int, size: tuple[int, int] = (96, 64), step: int = 2) -> list[Image]:
    """Pictures (H, W, 3) of a texture that moves, with noise."""
    chance = np.random.default_rng(4)
    floor = cv2.GaussianBlur(chance.normal(128, 120, (size[1], size[0] + step * count)), (0, 0), 2.0)
    seen = (floor[:, k * step:k * step + size[0]] + chance.normal(0, 6, size[::-1]) for k in range(count))
    return [np.repeat(np.clip(one, 0, 255).astype(np.uint8)[:, :, None], 3, 2) for one in seen]


def encoded(pictures: Sequence[Image], every: int = 10, rate: int = 30, more: str = "") -> list[bytes]:
    """A byte stream (Annex B) for each picture, as a camera without delay makes them; a key frame `every` so many.

    `more` are options of x264, each after a colon.
    """
    context = av.CodecContext.create("libx264", "w")
    assert isinstance(context, VideoCodecContext)
    context.height, context.width = pictures[0].shape[:2]
    context.pix_fmt, context.framerate, context.gop_size = "yuv420p", Fraction(rate), every
    context.options = {"preset": "ultrafast", "tune": "zerolatency",
                       "x264-params": f"repeat-headers=1:aud=0:scenecut=0{more}"}
    units = []
    for picture in [*map(av.VideoFrame.from_ndarray, pictures, ["bgr24"] * len(pictures)), None]:
        units += [bytes(packet) for packet in context.encode(picture)]
    return units


def plainly_decoded(units: Sequence[bytes]) -> list[Image]:
    """The pictures of units that have all come."""
    context = av.CodecContext.create("h264", "r")
    assert isinstance(context, VideoCodecContext)
    context.thread_count = 1
    pictures = [p for unit in units for p in context.decode(av.Packet(unit))] + context.decode(None)
    return [picture_of(p, "test") for p in pictures]


def nal_units(stream: bytes) -> list[bytes]:
    """The NAL units of a byte stream."""
    return [unit for unit in re.split(rb"\x00{2,}\x01", stream) if unit]


def payloads(stream: bytes) -> list[bytes]:
    """RTP payloads of a picture (RFC 6184): its small first units together, large ones in parts."""
    units = nal_units(stream)
    heads = [unit for unit in units if unit[0] & 31 in (6, 7, 8) and len(unit) < MTU // 4]
    out = []
    if len(heads) > 1:
        out.append(b"\x78" + b"".join(struct.pack(">H", len(unit)) + unit for unit in heads))
        units = [unit for unit in units if unit not in heads]
    for unit in units:
        if len(unit) <= MTU:
            out.append(unit)
            continue
        parts = [unit[k:k + MTU] for k in range(1, len(unit), MTU)]
        for k, part in enumerate(parts):
            ends = 128 * (k == 0) | 64 * (k == len(parts) - 1)
            out.append(bytes([unit[0] & 0xE0 | 28, ends | unit[0] & 31]) + part)
    return out


def packets(units: Sequence[bytes], rate: float = 30, number: int = 65500, stamp: int = (1 << 32) - 10_000,
            sender: int = SENDER, kind: int = 96) -> list[list[bytes]]:
    """RTP packets of each picture; numbers and stamps pass their end early on."""
    out: list[list[bytes]] = []
    for k, unit in enumerate(units):
        parts = payloads(unit)
        when = (stamp + round(k * TICKS / rate)) % (1 << 32)
        marks = [kind | 128 * (j == len(parts) - 1) for j in range(len(parts))]
        out.append([struct.pack(">BBHII", 128, mark, (number + j) % 65536, when, sender) + part
                    for j, (mark, part) in enumerate(zip(marks, parts, strict=True))])
        number += len(parts)
    return out


def free_port(kind: int = socket.SOCK_DGRAM) -> int:
    """A port that nobody has."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind((HOST, 0))
        return int(probe.getsockname()[1])


@contextmanager
def running(work: Any, *arguments: Any) -> Iterator[Event]:
    """`work(stop, *arguments)` in a thread, until the end of the `with`."""
    stop = Event()
    thread = Thread(target=work, args=(stop, *arguments), daemon=True)
    thread.start()
    try:
        yield stop
    finally:
        stop.set()
        thread.join(5)
        assert not thread.is_alive()


def send(stop: Event, port: int, pictures: Sequence[Sequence[bytes]], rate: float = 30.0, after: float = 0.0) -> None:
    """Send datagrams of pictures to a port at a rate, once, `after` so many seconds."""
    stop.wait(after)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        start = time.monotonic()
        for k, parts in enumerate(pictures):
            if stop.wait(max(0.0, start + k / rate - time.monotonic())):
                return
            for part in parts:
                out.sendto(part, (HOST, port))


class RtspCamera:
    """An RTSP server for one client at a time, which sends RTP in the connection itself.

    Args:
        units: one for each picture; those of each connection in turn.
        rate: pictures a second.
        hang: whether it is silent after the last picture instead of closing the connection.
    """

    def __init__(self, *units: Sequence[bytes], rate: float = 60.0, hang: bool = False) -> None:
        self.units, self.rate, self.hang = units, rate, hang
        self.asked: list[str] = []
        self.sent_at: list[float] = []
        self._listener = socket.create_server((HOST, 0))
        self._listener.settimeout(0.05)
        self.url = f"rtsp://{HOST}:{self._listener.getsockname()[1]}/cam"

    def __call__(self, stop: Event) -> None:
        """Serve until told to stop."""
        with self._listener:
            served = 0
            while not stop.is_set():
                try:
                    client, _ = self._listener.accept()
                except TimeoutError:
                    continue
                with client:
                    client.settimeout(0.05)
                    with suppress(OSError):
                        self._serve(stop, client, self.units[min(served, len(self.units) - 1)])
                served += 1

    def _serve(self, stop: Event, client: socket.socket, units: Sequence[bytes]) -> None:
        left: list[list[bytes]] | None = None
        start, done = 0.0, 0
        while not stop.is_set():
            request = _request(client, 0.0 if left else 0.05)
            if request is None:
                return
            if request:
                left = self._answer(client, request, units) or left
                start = start or (time.monotonic() if left else 0.0)
            if left and stop.wait(max(0.0, start + done / self.rate - time.monotonic())):
                return
            if left:
                self.sent_at.append(time.monotonic())
                for packet in left.pop(0):
                    client.sendall(struct.pack(">cBH", b"$", 0, len(packet)) + packet)
                done += 1
            if left == [] and not self.hang:
                return

    def _answer(self, client: socket.socket, request: str, units: Sequence[bytes]) -> list[list[bytes]] | None:
        """Answer a request; the packets to send, if it asks for them."""
        method = request.split(" ", 1)[0]
        self.asked.append(method)
        number = re.findall(r"(?im)^CSeq: *(\d+)", request)[0]
        head, body = "", ""
        if method == "OPTIONS":
            head = "Public: OPTIONS, DESCRIBE, SETUP, PLAY, TEARDOWN\r\n"
        elif method == "DESCRIBE":
            sets = ",".join(base64.b64encode(unit).decode() for unit in nal_units(units[0]) if unit[0] & 31 in (7, 8))
            body = (f"v=0\r\no=- 1 1 IN IP4 {HOST}\r\ns=camera\r\nt=0 0\r\nm=video 0 RTP/AVP 96\r\n"
                    "a=rtpmap:96 H264/90000\r\na=fmtp:96 packetization-mode=1;sprop-parameter-sets="
                    f"{sets}\r\na=control:track0\r\n")
            head = f"Content-Type: application/sdp\r\nContent-Base: {self.url}/\r\nContent-Length: {len(body)}\r\n"
        elif method == "SETUP":
            head = "Transport: RTP/AVP/TCP;unicast;interleaved=0-1\r\nSession: 7\r\n"
        client.sendall(f"RTSP/1.0 200 OK\r\nCSeq: {number}\r\n{head}\r\n{body}".encode())
        return packets(units, self.rate) if method == "PLAY" else None


def _request(client: socket.socket, wait: float) -> str | None:
    """A request; empty if none has come, None if the client has gone."""
    client.settimeout(wait or 0.001)
    try:
        data = client.recv(4096)
    except TimeoutError:
        return ""
    finally:
        client.settimeout(2.0)
    while data and b"\r\n\r\n" not in data and data[:1] != b"$":
        data += client.recv(4096)
    return None if not data else "" if data[:1] == b"$" else data.decode()


@contextmanager
def mjpeg_camera(*films: Sequence[Image], rate: float = 60.0) -> Iterator[str]:
    """A web camera that shows each connection the next film, the last one again and again; gives its address."""
    left = list(films)

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            film = left.pop(0) if len(left) > 1 else left[0]
            self.send_response(200)
            self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=next")
            self.end_headers()
            for picture in film:
                data = cv2.imencode(".jpg", picture)[1].tobytes()
                self.wfile.write(b"--next\r\nContent-Type: image/jpeg\r\nContent-Length: %d\r\n\r\n%s\r\n"
                                 % (len(data), data))
                time.sleep(1 / rate)

        def log_message(self, format: str, *values: Any) -> None:
            pass

    server = ThreadingHTTPServer((HOST, 0), Handler)
    server.handle_error = lambda *_: None  # type: ignore[method-assign]  # the client goes when it has enough
    thread = Thread(target=server.serve_forever, args=(0.05,), daemon=True)
    thread.start()
    try:
        yield f"http://{HOST}:{server.server_address[1]}/stream"
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
