# SPDX-License-Identifier: Apache-2.0
"""Live video by PyAV: RTSP, MJPEG over HTTP, cameras of V4L2; and what all streams have in common.

A stream that stops is connected to again until it is back or the run ends; one that cannot be had at the start is an
error. Nothing here holds pictures back: decoders have one thread and low delay, and what is waiting is bounded by the
sockets.
"""

from __future__ import annotations

import time
from abc import abstractmethod
from collections.abc import Iterator
from typing import Any

import av
from av.codec.context import Flags
from av.error import ExitError, FFmpegError
from av.video.codeccontext import VideoCodecContext
from av.video.frame import VideoFrame

from signum.common.checks import check_pixels
from signum.common.console import notes
from signum.common.errors import SourceError
from signum.common.urls import without_secrets
from signum.frames.frame import Frame
from signum.sources.decode import picture_of
from signum.sources.live import LiveSource

QUIET_S = 5.0
"""Silence after which a stream counts as stopped, seconds; also the longest wait for a connection."""
STALE_S = 0.05
"""Age from which a picture is passed over where the next one is there already, seconds: the reader was held up."""
READY_S = 0.002
"""Time within which a packet comes that was there already, seconds."""
AGAIN_S = 0.5
"""Pause before a stream is connected to again, seconds."""
PROTOCOLS = "rtsp,rtsps,rtp,tcp,udp,http,https,tls,crypto,httpproxy"
"""What a stream may lead to: no files of this computer."""
PARSED = "h264", "hevc"
"""Codecs whose pictures in RTP have no end of their own for FFmpeg: each is given one period late."""
REMEDY = {"rtsp": "mend the address, or start the camera's server", "http": "mend the address, or start its server",
          "device": "list the cameras with `ls /dev/video*`, and end what else uses it"}


class StreamSource(LiveSource):
    """A live stream that is connected to again when it stops. Frames are numbered from 0 as they come."""

    leave_s = 0.25  # FFmpeg may wait for the network; a run that is stopped does not wait for it

    @abstractmethod
    def _pictures(self) -> Iterator[tuple[float, VideoFrame | None]]:
        """Time of arrival and picture, of one connection, until it ends; no picture where it is passed over.

        Raises:
            FFmpegError: OSError: if there is no connection, or it breaks.
        """

    @abstractmethod
    def _refused(self, reason: str) -> SourceError:
        """The error of a stream that cannot be had."""

    def _arrivals(self) -> Iterator[Frame]:
        done, reason = 0, ""
        while not self.stopping.is_set():
            lost_at = done
            try:
                for came, picture in self._pictures():
                    if picture is None:
                        self.skipped += 1
                    else:
                        yield Frame(str(done), picture_of(picture, f"{self.label}: frame {done}"), came)
                    done += 1
                reason = "it ended"
            except (FFmpegError, OSError) as error:
                reason = reason_of(error)
            if not done and not self.stopping.is_set():
                raise self._refused(reason)
            if done > lost_at and not self.stopping.is_set():  # once, however often the connection then fails
                notes.print(f"{self.label}: the stream stopped after frame {done - 1} ({reason}); connecting again "
                            "until it is back")
            self.stopping.wait(AGAIN_S)


class AvSource(StreamSource):
    """A stream that FFmpeg connects to.

    Args:
        address: `rtsp://...`, `http://...`, or the path of a device.
        kind: FFmpeg's name of a device's driver; None for a network's stream.
    """

    def __init__(self, address: str, kind: str | None = None) -> None:
        super().__init__(without_secrets(address))
        self.address, self.kind = address, kind

    def _refused(self, reason: str) -> SourceError:
        kind = "device" if self.kind else "rtsp" if self.address.lower().startswith("rtsp") else "http"
        return SourceError(f"{self.label}: cannot be opened ({reason}); {REMEDY[kind]}")

    def _pictures(self) -> Iterator[tuple[float, VideoFrame | None]]:
        # Little is read before the first picture. RTSP comes by TCP, which loses nothing: of a picture with parts of it
        # missing FFmpeg would make one up.
        options = {} if self.kind else {
            "protocol_whitelist": PROTOCOLS, "rtsp_transport": "tcp", "fflags": "nobuffer", "analyzeduration": "500000",
            "probesize": "500000", "fpsprobesize": "0"}
        with av.open(self.address, "r", format=self.kind, container_options=options, metadata_errors="replace",
                     timeout=(QUIET_S, QUIET_S)) as container:
            if not container.streams.video or container.streams.video[0].codec_context is None:
                raise OSError("no video in it that can be decoded")
            stream = container.streams.video[0]
            hurry(stream.codec_context)
            # Of RTSP FFmpeg's parser gives a picture when the next one begins: one period after it came itself.
            late = self.kind is None and container.format.name == "rtsp" and stream.codec_context.name in PARSED
            begun: float | None = None
            waiting = Backlog()
            for packet in container.demux(stream):
                came = now = time.monotonic()
                if late:
                    came, begun = begun or now, now
                if self.stopping.is_set():
                    return
                stale = waiting.is_stale(packet.pts and float(packet.pts * packet.time_base), now)
                for picture in decoded(stream.codec_context, packet, self.label):
                    yield came, None if stale else picture
                waiting.asked = time.monotonic()


class Backlog:
    """Tells packets that were waiting while the reader was held up from those that just came.

    Attributes:
        asked: when the next packet was asked for, seconds on the monotonic clock.
    """

    def __init__(self) -> None:
        self.asked = 0.0
        self._least: float | None = None

    def is_stale(self, stamp: float | None, now: float) -> bool:
        """Whether a packet with a time stamp, seconds, came late and others are likely to wait behind it."""
        if stamp is None:
            return False
        self._least = now - stamp if self._least is None else min(self._least, now - stamp)
        return now - self.asked < READY_S and now - stamp - self._least > STALE_S


def hurry(context: VideoCodecContext) -> VideoCodecContext:
    """The decoder, so that it holds no picture back."""
    context.thread_type = "NONE"
    context.thread_count = 1
    context.flags |= Flags.low_delay
    return context


def decoded(context: VideoCodecContext, packet: Any, label: str) -> Iterator[VideoFrame]:
    """The pictures of a packet; none of one that is damaged.

    Raises:
        SourceError: if they are larger than the limit.
    """
    try:
        pictures = [picture for picture in context.decode(packet) if not picture.is_corrupt]
    except FFmpegError:
        return
    for picture in pictures:
        check_pixels(picture.width, picture.height, label, SourceError)
        yield picture


def reason_of(error: Exception) -> str:
    """What the system says, on one line."""
    if isinstance(error, ExitError):  # by the time that PyAV was given
        return f"nothing has come for {QUIET_S:g} s"
    return " ".join(str(getattr(error, "strerror", None) or error).split())
