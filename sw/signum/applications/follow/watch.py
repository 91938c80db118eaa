# SPDX-License-Identifier: Apache-2.0
"""Following on recorded or live frames: segmentation and follower of the closed loop, without steering."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from signum.applications.follow.eyes import Eye
from signum.applications.follow.follower import Follower, Target
from signum.common.arrays import Image


def watch_fish(eye: Eye, pictures: Iterable[tuple[Image, ...]]) -> Iterator[Target]:
    """The target of every frame, or rectified pair, each uint8 (height, width) of the eye's size."""
    follower = Follower(eye)
    for frames in pictures:
        yield follower.step(frames)
