# SPDX-License-Identifier: Apache-2.0
"""Frames of a video file, each with its time of presentation, by PyAV."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import av
from av.container import InputContainer
from av.error import FFmpegError

from signum.common.checks import check_file, check_pixels
from signum.common.console import notes
from signum.common.errors import SourceError
from signum.frames.frame import Frame, Source
from signum.sources.decode import picture_of

MOST_FRAMES = 10**9
"""Number of frames above which a video's own count is not believed."""


class VideoSource(Source):
    """A video file of any kind that FFmpeg decodes; a frame keeps its own size and its time of presentation."""

    def __init__(self, file: Path) -> None:
        self.file = file
        with self._opened() as container:
            stream = container.streams.video[0]
            found = stream.frames
            rate = stream.average_rate or stream.guessed_rate
            if not found and container.duration and rate:
                found = round(container.duration / 1e6 * float(rate))
        super().__init__(str(file), found if 0 < found < MOST_FRAMES else None)
        self.rate = float(rate) if rate and 0.1 <= rate <= 1000 else None

    @contextmanager
    def _opened(self) -> Iterator[InputContainer]:
        check_file(self.file, "video", SourceError)
        mend = f"try `ffmpeg -i {self.file.name} -c:v libx264 mended.mp4`"
        try:
            # By descriptor: the name may look like a network address, or be no UTF-8.
            with self.file.open("rb") as data, av.open(data, "r", metadata_errors="replace") as container:
                if not container.streams.video:
                    raise SourceError(f"{self.file}: no picture track in it; {mend}")
                context = container.streams.video[0].codec_context
                if context is None:  # PyAV's stubs do not know of streams without a decoder
                    raise SourceError(f"{self.file}: a video of a kind that cannot be decoded; {mend}")
                check_pixels(context.width, context.height, str(self.file), SourceError)
                yield container
        except (FFmpegError, ValueError) as error:
            raise SourceError(f"{self.file}: not a video that can be decoded (empty, cut short or of an unknown "
                              f"kind); {mend}") from error

    def _frames(self) -> Iterator[Frame]:
        done = 0
        latest = -1.0
        with self._opened() as container:
            stream = container.streams.video[0]
            stream.thread_type = "AUTO"
            frames = container.decode(stream)
            while True:
                try:
                    frame = next(frames)
                except (StopIteration, FFmpegError):
                    break
                moment = frame.time if frame.time is not None else done / (self.rate or 10.0)
                latest = max(latest, moment)
                yield Frame(str(done), picture_of(frame, f"{self.label}: frame {done}"), latest)
                done += 1
        # A container's count may be off by a few frames; if a tenth is missing, the file was cut short.
        if self.count is not None and 0 < done < 0.9 * self.count - 1:
            raise SourceError(self._broken(done))
        if self.count is not None and 0 < done != self.count:
            lost = (f": frames {done} to {self.count - 1} are missing, or as many before them, so that later ones have "
                    "too low a number" if done < self.count else "")
            notes.print(f"{self.file}: the file lists {self.count} frames, {done} could be decoded{lost}")

    def _broken(self, done: int) -> str:
        return (f"{self.file}: broken after frame {done - 1} of {self.count}; what came before is kept; "
                f"mend the file with `ffmpeg -i {self.file.name} -c:v libx264 mended.mp4`")
