# SPDX-License-Identifier: Apache-2.0
"""The compiled kernel: the bits of the NumPy model in every field, on every variant that this processor has."""

from __future__ import annotations

import multiprocessing
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import skimage.data
from hypothesis import given, settings
from hypothesis import strategies as st

from golden import correlate, log
from golden.compiled import build, calls
from golden.compiled.calls import CHOICE, choose, pack, unpack, variants
from golden.correlate import Job, Plane, Status
from golden.params import FULL, TINY, Config
from golden.tables import (
    JOB_FIELDS,
    check_fields,
    check_table,
    jobs_table,
    results_table,
    table_jobs,
    table_results,
)
from golden.tests.test_correlate import GOOD, PLANES, SIZE, jobs, random_plane
from golden.tests.test_log import DATA

WIDE = (330, 140)
SHAPES = ((8, 8, 1, 1), (64, 64, 65, 65), (128, 128, 73, 3), (127, 33, 64, 33), (65, 12, 96, 4), (16, 16, 129, 1),
          (63, 8, 31, 2), (61, 9, 47, 30), (9, 128, 5, 7), (32, 32, 600, 440), (64, 48, 1, 66), (33, 20, 17, 17))
"""Windows and searches about the limits of words, of blocks of columns and of the rows that are counted together."""


def hold(laid: list[Job], planes: dict[int, Plane], config: Config) -> None:
    """Compare the results of every variant, and the surface of the first job, with the model."""
    size = next(iter(planes.values())).shape[::-1]
    packed = {slot: pack(plane) for slot, plane in planes.items()}
    expected = [correlate.run(job, planes, config, size) for job in laid]
    scores = correlate.surface(planes[laid[0].tpl_slot], planes[laid[0].search_slot], laid[0])
    for name, kernel in variants().items():
        found = kernel.search(jobs_table(laid), packed)
        assert table_results(found, [job.tag for job in laid]) == expected, name
        result, surface = kernel.surface(jobs_table(laid[:1]), packed)
        assert np.array_equal(result, found[:1]) and np.array_equal(surface, scores), name


@settings(max_examples=60, deadline=None)
@given(st.data(), PLANES, PLANES)
def test_results_of_small_jobs(data: st.DataObject, a: Plane, b: Plane) -> None:
    """Ties, borders, empty and full planes, several jobs in a call."""
    laid = data.draw(st.lists(jobs(), min_size=1, max_size=4))
    hold(laid, {0: a, 1: b}, TINY)


@settings(max_examples=25, deadline=None)
@given(jobs(WIDE, FULL), st.integers(0, 99), st.sampled_from([0.5, 0.1, 0.9]))
def test_results_of_large_jobs(job: Job, seed: int, ones: float) -> None:
    """Windows to 128 pixels wide, of two words, searches to 323 offsets across."""
    hold([job], {k: random_plane(seed + k, WIDE, ones) for k in (0, 1)}, FULL)


@pytest.mark.parametrize("ones", [0.5, 1.0])
def test_results_about_the_limits_of_words_and_blocks(ones: float) -> None:
    rng = np.random.default_rng(8)
    planes = {3: random_plane(1, (640, 480), 1 - ones), 5: random_plane(2, (640, 480), ones)}
    laid = []
    for w, h, nx, ny in SHAPES:
        right, low = 640 - w - nx + 1, 480 - h - ny + 1  # the last places of the search
        for x, y in ((0, 0), (right, low), (int(rng.integers(right + 1)), int(rng.integers(low + 1)))):
            laid.append(Job(3, int(rng.integers(640 - w + 1)), int(rng.integers(480 - h + 1)), w, h, 5, x, y, nx, ny))
    hold(laid, planes, FULL)


def _seabed() -> Iterator[tuple[log.Image, log.Image]]:
    """Pairs of overlapping real frames: photographs, and a survey beside the project where it is present."""
    for name in ("gravel", "grass"):
        photo = np.asarray(cv2.resize(getattr(skimage.data, name)(), (520, 400)), np.uint8)
        yield photo[:380, :500], photo[13:393, 9:509]
    files = sorted((DATA / "skerki").glob("*.tif"))[:2]
    if len(files) == 2:
        one, two = (cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) for file in files)
        assert one is not None and two is not None
        yield np.asarray(one, np.uint8), np.asarray(two, np.uint8)


def test_real_frames() -> None:
    """Planes and results of overlapping frames of real ground."""
    for one, two in _seabed():
        height, width = one.shape
        planes = {k: log.sign(frame, 2.5) for k, frame in enumerate((one, two))}
        for k, frame in enumerate((one, two)):
            for kernel in variants().values():
                assert np.array_equal(unpack(kernel.sign(frame, 2.5, FULL.radius), width), planes[k])
        laid = [Job(0, x, y, w, w, 1, x - r, y - r, 2 * r + 1, 2 * r + 1) for w, r in ((32, 8), (64, 20), (96, 16))
                for x in range(r, width - w - r, 120) for y in range(r, height - w - r, 120)]
        hold(laid, planes, FULL)


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 150), st.integers(1, 40), st.sampled_from([0.6, 1.0, 1.7, 2.5, 4.0]),
       st.sampled_from([TINY.radius, FULL.radius]), st.integers(0, 99))
def test_the_filter(width: int, height: int, sigma: float, radius: int, seed: int) -> None:
    """Pictures of any size, smooth ones too, whose responses lie about zero."""
    rng = np.random.default_rng(seed)
    image = rng.integers(0, 256, (height, width), dtype=np.uint8)
    if seed % 3:
        image = np.asarray(cv2.GaussianBlur(image, (0, 0), seed / 10), np.uint8)
    if seed % 3 == 2:
        image = np.where(image > 128, 255, 0).astype(np.uint8)
    expected = log.response(image, sigma, radius)
    for kernel in variants().values():
        assert np.array_equal(kernel.response(image, sigma, radius), expected)
        assert np.array_equal(unpack(kernel.sign(image[:, ::-1], sigma, radius), width), expected[:, ::-1] > 0)


def test_bad_pictures_are_named() -> None:
    for kernel in variants().values():
        with pytest.raises(ValueError, match="8-bit grey"):
            kernel.sign(np.zeros((20, 20), np.float32), 2.0, 16)
        with pytest.raises(ValueError, match="sigma"):
            kernel.sign(np.zeros((20, 20), np.uint8), 9.0, 16)


@given(st.integers(1, 200), st.integers(1, 5), st.integers(0, 99))
def test_packing(width: int, height: int, seed: int) -> None:
    plane = random_plane(seed, (width, height))
    packed = pack(plane)
    assert packed.shape == (height, -(-width // 64) + 1)
    assert np.array_equal(unpack(packed, width), plane)
    assert not unpack(packed, 64 * packed.shape[1])[:, width:].any()


@settings(max_examples=60)
@given(st.lists(jobs(), min_size=1, max_size=5), st.data())
def test_tables_check_as_jobs_do(laid: list[Job], data: st.DataObject) -> None:
    """Jobs of all kinds, refused ones included, through a table and back."""
    laid = [replace(job, tag=0, surface=False, **{data.draw(st.sampled_from(JOB_FIELDS)): data.draw(st.integers(0, 7))})
            for job in laid]
    table = jobs_table(laid)
    check_fields(table)
    assert table_jobs(table) == laid
    valid = [True, True, *data.draw(st.lists(st.booleans(), min_size=4, max_size=4))]
    assert check_table(table, TINY, SIZE, valid).tolist() == [
        correlate.check(job, TINY, SIZE, [*valid, False, False]) for job in laid]
    results = [correlate.Result(7, Status.OUTSIDE),
               correlate.Result(9, Status.OK, 1, 2, 3, (4, 5, 6, 7, 8, 9, 0, 1), 2)]
    assert table_results(results_table(results), [7, 9]) == results


def test_a_table_names_what_does_not_fit() -> None:
    table = jobs_table([GOOD])
    table[0, JOB_FIELDS.index("offsets_x")] = 1024
    with pytest.raises(ValueError, match=r"offsets_x is 1024: must lie in 0\.\.1023"):
        check_fields(table)


def test_the_environment_chooses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(CHOICE, raising=False)
    kernel, told = choose()
    assert kernel is list(variants().values())[-1] and told == f"compiled, {kernel.variant}"
    monkeypatch.setenv(CHOICE, "plain")
    assert choose()[1] == "compiled, plain"
    monkeypatch.setenv(CHOICE, "numpy")
    assert choose() == (None, f"NumPy, chosen by {CHOICE}")
    monkeypatch.setenv(CHOICE, "mmx")
    with pytest.raises(ValueError, match="mmx: this processor has numpy, plain"):
        choose()


@pytest.mark.parametrize("command", [("no-such-compiler",), ("false",), ("sleep", "5")])
def test_without_a_compiler_numpy_computes(command: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, tmp_path: Path,
                                           ) -> None:
    """It says why, and leaves nothing behind that looks like a library."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv(CHOICE, raising=False)
    monkeypatch.setattr(build, "COMMAND", command)
    monkeypatch.setattr(build, "PATIENCE_S", 0.2)
    monkeypatch.setattr(calls, "variants", variants.__wrapped__)
    kernel, told = choose()
    assert kernel is None and told.startswith("NumPy, as the kernel cannot be had: ") and "\n" not in told
    assert command[0] in told
    assert not list(tmp_path.rglob("*.so"))
    monkeypatch.setenv(CHOICE, "plain")
    with pytest.raises(ValueError, match="cannot be had"):
        choose()


def test_a_cache_that_cannot_be_written(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    (tmp_path / "file").write_text("not a folder")
    with pytest.raises(build.KernelError, match="Not a directory"):
        build.library()


def _ask(asked: int) -> str:
    return str(build.library())


def test_processes_that_ask_at_once_compile_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A compiler that is slow, counts its calls, and writes its output in two parts."""
    slow = tmp_path / "slow"
    slow.write_text(f'#!/bin/sh\necho call >> {tmp_path}/calls\nfor out; do :; done\nprintf one > "$out"\nsleep 0.3\n'
                    'printf two >> "$out"\n')
    slow.chmod(0o755)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(build, "COMMAND", (str(slow),))
    with multiprocessing.get_context("fork").Pool(4) as pool:
        paths = set(pool.map(_ask, range(8)))
    (path,) = paths
    assert Path(path).read_text() == "onetwo"
    assert (tmp_path / "calls").read_text() == "call\n"
    assert sorted(p.name for p in Path(path).parent.iterdir()) == [".lock", Path(path).name]


def test_a_changed_source_is_compiled_anew(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(build, "COMMAND", ("sh", "-c", 'for out; do :; done; : > "$out"', "sh"))
    monkeypatch.setattr(build, "HERE", tmp_path / "sources")
    (tmp_path / "sources").mkdir()
    (tmp_path / "sources" / "kernel.cpp").write_text("1")
    first = build.library()
    assert build.library() == first
    (tmp_path / "sources" / "kernel.cpp").write_text("2")
    assert build.library() != first and first.exists()


def test_the_sources_compile_without_warnings(tmp_path: Path) -> None:
    done = subprocess.run(["g++", "-std=c++17", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Werror",
                           build.HERE / "kernel.cpp"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
