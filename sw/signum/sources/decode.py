# SPDX-License-Identifier: Apache-2.0
"""Compressed video to pictures, by PyAV (FFmpeg's libraries): for files, streams and messages that hold video."""

from __future__ import annotations

from collections.abc import Iterator

import av
import numpy as np
from av.error import FFmpegError
from av.video.codeccontext import VideoCodecContext
from av.video.frame import VideoFrame

from signum.common.arrays import Image
from signum.common.checks import check_pixels
from signum.common.errors import SourceError

# No callback of PyAV's: it takes the interpreter's lock in the decoder's threads, and closing a video waits for these
# with the lock held. What is wrong is said in one line of our own.
av.logging.set_level(None)
CODECS = {"h264": "h264", "avc": "h264", "h265": "hevc", "hevc": "hevc", "vp8": "vp8", "vp9": "vp9", "av1": "av1",
          "mjpeg": "mjpeg", "jpeg": "mjpeg"}
"""Names of codecs in messages, and FFmpeg's."""


def picture_of(frame: VideoFrame, label: str) -> Image:
    """A decoded frame as blue, green, red, or grey where it has no colour, turned as its file says.

    Args:
        frame: of any pixel format and size.
        label: of the frame, for messages.

    Raises:
        SourceError: if it is larger than the limit.
    """
    check_pixels(frame.width, frame.height, label, SourceError)
    grey = frame.format.name.startswith("gray")
    picture = np.asarray(frame.to_ndarray(format="gray" if grey else "bgr24"), np.uint8)
    turns = round(frame.rotation / 90) % 4
    return np.ascontiguousarray(np.rot90(picture, turns)) if turns else picture


class MessageDecoder:
    """Decodes a video whose frames come one by one, each in a message of its own.

    Args:
        codec: as messages name it, such as "h264".
        label: of the source, for messages.

    Raises:
        SourceError: if the codec is not known.
    """

    def __init__(self, codec: str, label: str) -> None:
        name = CODECS.get(codec.lower().partition(";")[0].strip())
        if name is None:
            raise SourceError(f"{label}: video of kind {codec!r}; signum reads {', '.join(sorted(CODECS))}")
        self._label = label
        context = av.CodecContext.create(name, "r")
        assert isinstance(context, VideoCodecContext)
        self._context = context
        self._context.thread_count = 1  # threads would hold frames back
        self.refused = 0
        """Messages that gave no picture: before the first key frame, or damaged."""

    def __call__(self, data: bytes) -> Iterator[VideoFrame]:
        """The frames that a message completes: one, as a rule; none before the first key frame."""
        try:
            frames = [f for f in self._context.decode(av.Packet(data)) if not f.is_corrupt] if data else []
        except FFmpegError:
            frames = []
        self.refused += not frames
        yield from frames

    def rest(self) -> Iterator[VideoFrame]:
        """The frames that the decoder still holds."""
        try:
            yield from self._context.decode(None)
        except FFmpegError:
            return
