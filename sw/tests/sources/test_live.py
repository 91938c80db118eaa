# SPDX-License-Identifier: Apache-2.0
"""A live source gives the newest frame, counts those it skips, and hands on what ended it."""

import time
from collections.abc import Iterator

import numpy as np
import pytest

from signum.common.checks import check_pixels, megapixels
from signum.common.errors import SourceError
from signum.frames.frame import Frame
from signum.sources.live import LiveSource

PERIOD_S = 0.02
FRAMES = 40


class Clockwork(LiveSource):
    """Frames by the clock, as a camera gives them."""

    def __init__(self, breaks: bool = False) -> None:
        super().__init__("clockwork")
        self.breaks = breaks
        self.given = 0

    def _arrivals(self) -> Iterator[Frame]:
        start = time.monotonic()
        for k in range(FRAMES):
            time.sleep(max(0.0, start + k * PERIOD_S - time.monotonic()))
            self.given += 1
            yield Frame(str(k), np.zeros((8, 8), np.uint8), time.monotonic())
            if self.stopping.is_set():
                return
        if self.breaks:
            raise SourceError("clockwork: the spring broke")


def test_slow_work_gets_the_newest_frame() -> None:
    """Work of five frame periods: read in turn, frames would lag behind by four for each one given.

    Ages are counted in frames, so that a busy machine changes nothing: one more may have come while one is handed over.
    """
    source = Clockwork()
    behind, names = [], []
    for frame in source:
        behind.append(source.given - 1 - int(frame.name))
        names.append(int(frame.name))
        time.sleep(5 * PERIOD_S)
    assert names[-1] == FRAMES - 1 and names == sorted(names)
    assert source.skipped == FRAMES - len(names) > FRAMES // 2
    assert max(behind) <= 1, behind


def test_what_ended_the_reader_is_raised_after_its_last_frame() -> None:
    seen = []
    with pytest.raises(SourceError, match="spring"):
        for frame in Clockwork(breaks=True):
            seen.append(frame.name)
    assert seen[-1] == str(FRAMES - 1)


def test_leaving_stops_the_reader() -> None:
    source = Clockwork()
    frames = iter(source)
    next(frames)
    frames.close()  # type: ignore[attr-defined]
    assert source.stopping.is_set() and source.given < FRAMES


def test_the_limit_of_a_pictures_size_holds_in_the_readers_thread() -> None:
    """Where a picture is decoded, before it is as large as the limit forbids."""
    class Large(Clockwork):
        def _arrivals(self) -> Iterator[Frame]:
            check_pixels(100, 100, "the decoder", SourceError)
            yield from super()._arrivals()

    assert next(iter(Large())).name == "0"
    with megapixels(0.005), pytest.raises(SourceError, match="the decoder: 100x100 are"):
        next(iter(Large()))
