# SPDX-License-Identifier: Apache-2.0
"""Times of frames: those that a source gives, made to advance, or counted by a rate where it gives none."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from signum.common.console import notes
from signum.frames.frame import Frame

FRAME_RATE = 10.0
"""Frames per second of a source that gives neither times nor a rate."""
STEP_S = 0.1
"""Step after a stamp that does not advance, where neither a rate nor an earlier step is known, seconds."""


def timed(frames: Iterable[Frame], label: str, rate: float | None = None) -> Iterator[Frame]:
    """Frames whose times advance from each to the next.

    A frame without a time gets its index over `rate`; without a rate it stays without. A time that does not advance
    gives way to the one before plus the last step, so that no speed is infinite; that is said once.

    Args:
        frames: in order.
        label: of their source, for the message.
        rate: frames per second of a source without times.
    """
    last: float | None = None
    step, said = 1 / rate if rate else STEP_S, False
    for k, frame in enumerate(frames):
        if k == 0 and frame.time_s is not None and rate:
            notes.print(f"{label}: its frames carry their own times; --rate {rate:g} is not used")
        time = frame.time_s if frame.time_s is not None else k / rate if rate else None
        if time is not None and last is not None:
            if time > last:
                step = time - last
            else:
                if not said:
                    notes.print(f"{label}: the time of frame {frame.name} ({time:.6f} s) is not after the one before "
                                f"({last:.6f} s): such frames are taken to be {step:.3g} s after the one before")
                said, time = True, last + step
        last = time if time is not None else last
        yield frame if time == frame.time_s else replace(frame, time_s=time)
