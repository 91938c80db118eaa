# SPDX-License-Identifier: Apache-2.0
"""The kernel against OpenCV, shortened; `make speed` has the commands' bars too."""

import pytest

from golden.compiled.calls import variants
from tests.speed import OVER_OPENCV, searches


def test_searches_are_as_fast_as_opencv() -> None:
    """Of the same search, in processor time, all taking turns; each variant of this processor that has a bar."""
    found = searches(rounds=3, count=20)
    held = {name: found[name] / found["opencv"] for name in variants() if name in OVER_OPENCV}
    if not held:
        pytest.skip("this processor has neither AVX2 nor AVX-512, for which the bars are")
    assert all(ratio >= OVER_OPENCV[name] for name, ratio in held.items()), held
