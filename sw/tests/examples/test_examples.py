# SPDX-License-Identifier: Apache-2.0
"""Every example runs and measures what it shows; the block taken out lints clean and passes its own test."""

import importlib.util
from pathlib import Path
from types import ModuleType

import cv2
import numpy as np
import pytest

from signum.common.files import write_picture
from signum.world.seafloor import photograph
from sim.testbench.runner import _keep_library, _reuse_library
from sim.toolchain import BUILD, ROOT, sources_of

EXAMPLES = ROOT / "examples"
MOST_LINES = 60


def example(name: str) -> ModuleType:
    """An example as a module."""
    spec = importlib.util.spec_from_file_location(f"example_{Path(name).stem}", EXAMPLES / name)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("board", ["golden", "verilated"])
def test_grid(board: str) -> None:
    found = example("grid.py")
    peaks = found.main(board)
    assert len(peaks) == 12
    assert max(np.hypot(p.dx - found.MOTION[0], p.dy - found.MOTION[1]) for p in peaks) < 0.25


def test_surface(tmp_path: Path) -> None:
    path = tmp_path / "surface.png"
    assert example("surface.py").main(str(path)) == (11, -7)
    assert cv2.imread(str(path)) is not None


def test_hover() -> None:
    """The simulated camera goes north at 0.3 m/s, five frames a second."""
    readings = example("hover.py").main("world:frames=5,water=coastal")
    assert all(r.valid for r in readings)
    assert [r.forward for r in readings] == pytest.approx([0.06 * k for k in range(5)], abs=0.01)


def test_mosaic(tmp_path: Path) -> None:
    """Four pictures cut out of a photograph, 48 pixels apart."""
    folder = tmp_path / "survey"
    folder.mkdir()
    photo = photograph("gravel")
    for k in range(4):
        write_picture(folder / f"{k}.png", photo[100:292, 40 + 48 * k:296 + 48 * k])
    assert example("mosaic.py").main(str(folder), str(tmp_path / "out")) == 4
    made = cv2.imread(str(tmp_path / "out" / "mosaic.png"))
    assert made is not None and made.shape[1] == pytest.approx(256 + 3 * 48, abs=4)


def test_a_block_in_another_design() -> None:
    """As on a machine without libpython."""
    folder = BUILD / "examples" / "my_design"
    folder.mkdir(parents=True, exist_ok=True)
    _reuse_library(folder, folder / "Vtop.mk")
    assert example("block/run.py").main(str(folder), plain=False) == 0
    _keep_library(folder)


def test_the_blocks_file_list_is_whole() -> None:
    block = EXAMPLES / "block"
    listed = [line for line in (block / "files.f").read_text().splitlines() if line.endswith(".sv")]
    assert [(block / line).resolve() for line in listed] == [*sources_of("slog_frontend"), block / "my_design.sv"]


@pytest.mark.slow
def test_the_whole_board() -> None:
    example("board/run.py").main()


def test_examples_are_short() -> None:
    files = [path for kind in ("py", "sv") for path in EXAMPLES.rglob(f"*.{kind}")]
    long = [path.name for path in files if len(path.read_text().splitlines()) >= MOST_LINES]
    assert len(files) > 6 and not long
