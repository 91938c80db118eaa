# SPDX-License-Identifier: Apache-2.0
"""Configurations: contradictory ones are refused, and the committed packages are those of the named ones."""

from dataclasses import replace
from pathlib import Path

import pytest

from golden import params
from golden.log import kernels
from golden.params import (
    COEF_BITS,
    COEF_FRACTION,
    CONFIGS,
    FULL,
    MAX_SIGMA,
    MIN_SIGMA,
    NO_SCORE,
    PIXEL_BITS,
    ROOT,
    SCORE_BITS,
    TAG_BITS,
    TINY,
    Config,
    main,
)


@pytest.mark.parametrize(("change", "message"), [
    ({"group_bits": 6}, "power of two"), ({"group_bits": 2}, "power of two"), ({"min_window": 0}, "min_window"),
    ({"min_window": 9}, "min_window"), ({"max_height": 15}, "largest window"), ({"max_width": 17}, "LoG kernel"),
    ({"cameras": 3}, "cameras"), ({"slots": 1}, "slots"), ({"slots": 9}, "slots"), ({"max_width": 1024}, "10 bits"),
    ({"max_height": 1024}, "10 bits"), ({"cameras": 0}, "cameras"), ({"group_bits": 0}, "power of two"),
    ({"radius": 7}, "sigma 4"), ({"array": False}, "array or a dense"), ({"dense_offsets": 12}, "multiple"),
    ({"dense_offsets": 264}, "256 or less"), ({"dense_offsets": -8}, "256 or less"), ({"dense_lanes": 0}, "multiple"),
    ({"dense_window": 64}, "power of two"), ({"dense_window": 12}, "power of two"),
    ({"dense_sizes": 0}, "power of two"), ({"dense_window": 8, "dense_sizes": 4}, "smallest part")])
def test_contradictions_are_refused(change: dict[str, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(TINY, **change)  # type: ignore[arg-type]


@pytest.mark.parametrize("change", [
    {"group_bits": 4}, {"min_window": 1}, {"min_window": 8}, {"max_height": 18}, {"max_width": 18},
    {"cameras": 1}, {"cameras": 2}, {"slots": 2}, {"slots": 8}, {"max_width": 1023}, {"max_height": 1023},
    {"group_bits": 16, "max_height": 32, "max_width": 32}, {"dense_offsets": 256}, {"dense_offsets": 8, "array": False},
    {"dense_window": 8, "dense_sizes": 3}])
def test_limits_are_accepted(change: dict[str, int]) -> None:
    config = replace(TINY, **change)  # type: ignore[arg-type]
    assert all(getattr(config, name) == value for name, value in change.items())


def test_numbers_that_follow() -> None:
    c = replace(FULL, max_width=641, max_height=100 + 2 * FULL.radius)
    assert (c.max_window, c.pitch, c.lanes, c.min_image, c.coefs) == (128, 32, 33, 34, 17)
    assert (c.words_per_row, c.slot_words, c.store_words) == (11, 11 * 132, 6 * 11 * 132)
    assert (c.score_bits, c.ring_rows) == (15, 256)
    assert (PIXEL_BITS, SCORE_BITS, NO_SCORE, TAG_BITS) == (8, 15, 32767, 16)
    assert replace(c, dense_offsets=8).dense_windows == (32, 16, 8) and c.dense_windows == ()
    assert (COEF_BITS, COEF_FRACTION, MIN_SIGMA, MAX_SIGMA) == (18, 15, 1.0, 4.0)


def test_stale_packages_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                  capsys: pytest.CaptureFixture[str]) -> None:
    committed = {name: (ROOT / "rtl" / "gen" / name / "slog_cfg_pkg.sv").read_text() for name in CONFIGS}
    monkeypatch.setattr(params, "ROOT", tmp_path)
    assert main(["--check"]) == 1
    assert "tiny" in (said := capsys.readouterr().err) and "full" in said
    assert main([]) == 0 and main(["--check"]) == 0
    for name, text in committed.items():
        path = tmp_path / "rtl" / "gen" / name / "slog_cfg_pkg.sv"
        assert path.read_text() == text
        path.write_text("other")
    assert main(["--check"]) == 1


@pytest.mark.parametrize("config", CONFIGS.values(), ids=lambda c: c.name)
def test_every_board_takes_the_range_of_sigma(config: Config) -> None:
    for sigma in (MIN_SIGMA, MAX_SIGMA):
        assert len(kernels(sigma, config.radius)[0]) == config.coefs


def test_packages_are_current() -> None:
    assert main(["--check"]) == 0
