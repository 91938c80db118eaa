# SPDX-License-Identifier: Apache-2.0
"""Configurations: contradictory ones are refused, and the committed packages are those of the named ones."""

from dataclasses import replace

import pytest

from golden.log import kernels
from golden.params import CONFIGS, MAX_SIGMA, MIN_SIGMA, TINY, Config, main


@pytest.mark.parametrize(("change", "message"), [
    ({"group_bits": 6}, "power of two"), ({"group_bits": 2}, "power of two"), ({"min_window": 0}, "min_window"),
    ({"min_window": 9}, "min_window"), ({"max_height": 15}, "largest window"), ({"max_width": 17}, "LoG kernel"),
    ({"cameras": 3}, "cameras"), ({"slots": 1}, "slots"), ({"slots": 9}, "slots"), ({"max_width": 1024}, "10 bits"),
    ({"radius": 7}, "sigma 4")])
def test_contradictions_are_refused(change: dict[str, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(TINY, **change)  # type: ignore[arg-type]


@pytest.mark.parametrize("config", CONFIGS.values(), ids=lambda c: c.name)
def test_every_board_takes_the_range_of_sigma(config: Config) -> None:
    for sigma in (MIN_SIGMA, MAX_SIGMA):
        assert len(kernels(sigma, config.radius)[0]) == config.coefs


def test_packages_are_current() -> None:
    assert main(["--check"]) == 0
