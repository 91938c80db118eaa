# SPDX-License-Identifier: Apache-2.0
"""Live sources: the newest frame wins, so that the age of the frame in work is bounded however slow the work is.

A thread takes every frame as it comes and keeps the last. A frame that is asked for is therefore at most one frame
period old, or waited for; while it is worked on it grows older by that work. Frames replaced before they were asked for
are counted in `skipped`.
"""

from __future__ import annotations

import time
from abc import abstractmethod
from collections.abc import Iterator
from contextvars import copy_context
from threading import Condition, Event, Thread

import cv2
import numpy as np

from signum.common.errors import SourceError
from signum.frames.frame import Frame, Source


class LiveSource(Source):
    """A source whose frames come by themselves; a subclass gives them by `_arrivals`.

    Attributes:
        stopping: set when no more frames are wanted; `_arrivals` then returns.
    """

    live = True
    leave_s = 1.0
    """Longest wait for the reader to end, seconds; one that hangs ends with the process."""

    def __init__(self, label: str) -> None:
        super().__init__(label, None)
        self.stopping = Event()

    @abstractmethod
    def _arrivals(self) -> Iterator[Frame]:
        """Every frame as it comes, its time that of `time.monotonic()`; runs in a thread of its own."""

    def _frames(self) -> Iterator[Frame]:
        self.skipped, self.lost, self.oldest_s = 0, 0, 0.0
        self.stopping.clear()
        box = _Newest(self)
        # With the context of this thread, which holds the limit of a picture's size.
        reader = Thread(target=copy_context().run, args=(box.fill,), name=self.label, daemon=True)
        reader.start()
        try:
            while (frame := box.take()) is not None:
                if frame.time_s is not None:
                    self.oldest_s = max(self.oldest_s, time.monotonic() - frame.time_s)
                yield frame
        finally:
            self.stopping.set()
            reader.join(self.leave_s)


class _Newest:
    """One place for the newest frame, between the reader's thread and the consumer's."""

    def __init__(self, source: LiveSource) -> None:
        self._source = source
        self._change = Condition()
        self._frame: Frame | None = None
        self._ended = False
        self._error: BaseException | None = None

    def fill(self) -> None:
        """Put in every frame that comes, until there are no more."""
        try:
            for frame in self._source._arrivals():
                with self._change:
                    self._source.skipped += self._frame is not None
                    self._frame = frame
                    self._change.notify()
                if self._source.stopping.is_set():
                    break
        except BaseException as error:  # raised in the consumer's thread
            self._error = error
        with self._change:
            self._ended = True
            self._change.notify()

    def take(self) -> Frame | None:
        """The newest frame, waited for; None after the last.

        Raises:
            Exception: that ended the reader, after its last frame.
        """
        with self._change:
            while self._frame is None and not self._ended:
                self._change.wait(0.5)  # an interrupt is noticed
            frame, self._frame = self._frame, None
            if frame is None and self._error is not None:
                raise self._error
            return frame


class CameraSource(LiveSource):
    """A live camera by its OpenCV index, until the camera delivers no more frames."""

    def __init__(self, index: int) -> None:
        super().__init__(f"camera {index}")
        self.index = index

    def _arrivals(self) -> Iterator[Frame]:
        capture = cv2.VideoCapture(self.index)
        if not capture.isOpened():
            raise SourceError(f"{self.label}: cannot be opened; list the cameras with `ls /dev/video*`")
        try:
            done = 0
            while not self.stopping.is_set():
                good, picture = capture.read()
                if not good:
                    return
                yield Frame(str(done), np.asarray(picture, np.uint8), time.monotonic())
                done += 1
        finally:
            capture.release()
