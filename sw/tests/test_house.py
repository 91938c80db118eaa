# SPDX-License-Identifier: Apache-2.0
"""The rules of the house: who may import whom, the same rooms on both sides, one name for one thing, no long files."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FLOORS = ("common", "boards", "tables", "frames", "geometry", "measure", "world", "sources", "report", "applications",
          "reproduce", "demo", "commands")
"""Rooms of `sw/signum` from the ground up; a room may import those before it."""
ROOMS = {"array", "dense", "cells", "control", "correlator", "frontend", "peak", "store"}
"""Rooms of the RTL, of its cycle models and of their cocotb checks."""
ALLOWED = {
    "main": "the entry point of a module that is run",
    "make": "makes a section of the reproduction, one for each section",
    "sections": "the sections of a report, one for each kind of table",
}
"""Functions that several modules may define, as all of them do the same for their module."""
LONGEST = 400
REASON = f"Over {LONGEST} lines:"
"""Begins, within the first 40 lines of a longer file, the sentence that gives the reason for one file."""


def _modules(folder: Path, package: str) -> dict[str, Path]:
    """Files by dotted name, tests aside."""
    names = {path: path.relative_to(folder).with_suffix("").parts for path in folder.rglob("*.py")}
    return {".".join((package, *parts)).removesuffix(".__init__"): path for path, parts in names.items()
            if "tests" not in parts}


def _imports(name: str, path: Path) -> Iterator[str]:
    """Every name a file imports, inside functions too, but not for type checking alone."""
    package = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    waiting: list[ast.AST] = [ast.parse(path.read_text())]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            waiting += node.orelse
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(package[:len(package) - node.level + 1] if node.level else [])
            base = ".".join(filter(None, (base, node.module)))
            yield from (f"{base}.{alias.name}" for alias in node.names)
        else:
            waiting += ast.iter_child_nodes(node)


def _uses(modules: dict[str, Path]) -> dict[str, set[str]]:
    """Modules among these that each imports."""
    uses: dict[str, set[str]] = {}
    for name, path in modules.items():
        found = (i if i in modules else i.rpartition(".")[0] for i in _imports(name, path))
        uses[name] = {i for i in found if i in modules}
    return uses


def _floor(module: str) -> int:
    """Number of a module's floor; `signum` itself, which loads names of all rooms, lies above them."""
    room = module.split(".")[1:2]
    return FLOORS.index(room[0]) if room else len(FLOORS)


def test_every_room_has_its_floor() -> None:
    rooms = {path.parent.relative_to(ROOT / "sw" / "signum").parts[:1] for path in (ROOT / "sw/signum").rglob("*.py")}
    assert rooms == {(), *((floor,) for floor in FLOORS)}


def test_no_room_imports_one_above_it() -> None:
    uses = _uses(_modules(ROOT / "sw" / "signum", "signum"))
    assert sum(map(len, uses.values())) > 200, "imports are not found"
    wrong = [f"{a} imports {b}" for a, used in uses.items() for b in used if _floor(b) > _floor(a)]
    assert not wrong, "\n".join(wrong)


def test_no_two_modules_import_each_other() -> None:
    for package, folder in (("signum", "sw/signum"), ("golden", "golden"), ("sim", "sim")):
        try:
            TopologicalSorter(_uses(_modules(ROOT / folder, package))).prepare()
        except CycleError as error:
            raise AssertionError(" imports ".join(reversed(error.args[1]))) from error


def test_the_specification_and_the_simulation_stand_alone() -> None:
    barred = {"golden": {"cocotb", "cocotb_tests", "sim", "signum"}, "sim": {"signum"}, "cocotb_tests": {"signum"}}
    wrong = [f"{name} imports {used}" for package, tops in barred.items()
             for name, path in _modules(ROOT / package, package).items() for used in _imports(name, path)
             if used.split(".")[0] in tops or (package == "golden" and "tests" in used.split("."))]
    assert not wrong, "\n".join(wrong)


def test_rtl_cycle_models_and_checks_have_the_same_rooms() -> None:
    others = {"rtl": {"gen", "ecp5"}, "golden/cycle": set(), "cocotb_tests": {"env"}}
    for folder, also in others.items():
        rooms = {path.relative_to(ROOT / folder).parts[0] for kind in ("py", "sv")
                 for path in (ROOT / folder).glob(f"*/**/*.{kind}")}
        assert rooms - also == ROOMS, folder


def test_one_name_means_one_thing() -> None:
    """Public classes of the host, the specification and the simulation, and public functions of the host."""
    places: dict[str, list[str]] = defaultdict(list)
    for package, folder, kinds in (("signum", "sw/signum", (ast.ClassDef, ast.FunctionDef)),
                                   ("golden", "golden", (ast.ClassDef,)), ("sim", "sim", (ast.ClassDef,))):
        for module, path in _modules(ROOT / folder, package).items():
            for node in ast.parse(path.read_text()).body:
                if isinstance(node, kinds) and not node.name.startswith("_"):
                    places[node.name].append(module)
    assert len(places) > 300, "definitions are not found"
    wrong = [f"{name}: {', '.join(found)}" for name, found in places.items() if len(found) > 1 and name not in ALLOWED]
    assert not wrong, "\n".join(sorted(wrong))
    assert [name for name in ALLOWED if len(places[name]) < 2] == [], "no longer needed"


def test_a_long_file_gives_its_reason() -> None:
    long = []
    for top in ("rtl", "golden", "cocotb_tests", "sim", "sw"):
        for path in (ROOT / top).rglob("*"):
            if path.suffix in (".py", ".sv", ".svh", ".cpp", ".hpp") and "gen" not in path.parts:
                lines = path.read_text().splitlines()
                if len(lines) > LONGEST and not any(REASON in line for line in lines[:40]):
                    long.append(f"{path.relative_to(ROOT)}: {len(lines)} lines")
    assert not long, "\n".join(long)


def test_pictures_and_films_are_written_where_failures_are_seen() -> None:
    """OpenCV's writers say nothing on a full disk; `cv2.imwrite` is banned by the linter everywhere."""
    quiet = {"imwrite": set(), "VideoWriter": set(),
             "FILE_STORAGE_WRITE": {"signum.geometry.calibration"}}
    users: dict[str, set[str]] = {name: set() for name in quiet}
    for module, path in _modules(ROOT / "sw" / "signum", "signum").items():
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Attribute) and node.attr in quiet and ast.unparse(node.value) == "cv2":
                users[node.attr].add(module)
    assert users == quiet
