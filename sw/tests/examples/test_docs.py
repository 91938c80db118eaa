# SPDX-License-Identifier: Apache-2.0
"""The documentation names what there is: modules, columns, commands; pictures are as the scripts draw them."""

import importlib.util
import inspect
import re
import sys
from types import ModuleType

import pytest

from sim.toolchain import ROOT, RTL

DOCS = ROOT / "docs"
README_WORDS = 900


def tool(name: str) -> ModuleType:
    """A script of `docs/tools`."""
    spec = importlib.util.spec_from_file_location(f"docs_{name}", DOCS / "tools" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look there
    spec.loader.exec_module(module)
    return module


def test_every_module_is_listed_with_a_test_that_exists() -> None:
    rows = re.findall(r"^\| `(slog_\w+)` \| .+ \| `([\w/]+)` \|$", (DOCS / "reference/modules.md").read_text(), re.M)
    names = {path.stem for path in RTL.rglob("slog_*.sv") if not {"gen", "ecp5"} & set(path.parts)}
    assert {name for name, _ in rows} == {name for name in names if not name.endswith("_pkg")}
    missing = [test for _, test in rows if not (ROOT / "cocotb_tests" / f"{test}.py").exists()]
    assert not missing


def test_every_column_has_a_unit() -> None:
    pages = tool("pages")
    found = {name: [pages.unit(name, column) for column in columns] for name, columns, _ in pages.schemas()}
    assert len(found) > 12 and all(map(all, found.values()))


def test_every_command_and_option_is_on_the_page() -> None:
    from signum.commands.cli import COMMANDS
    page = tool("pages").commands_page()
    assert re.findall(r"^## signum (\w+)$", page, re.M) == sorted(COMMANDS)
    assert "`--board`" in page and "`golden`" in page


@pytest.mark.parametrize("name", ["board", "cells", "frontend", "store", "correlator", "array", "peak", "control"])
def test_diagrams_are_as_drawn(name: str) -> None:
    assert (DOCS / "img" / f"{name}.svg").read_text() == tool("diagrams").DIAGRAMS[name]().svg()


def test_every_room_has_a_timing_diagram_that_its_bench_compares() -> None:
    """The pictures themselves are compared by `timing_diagram` in these benches, which simulate the RTL."""
    waves = tool("waves")
    assert set(waves.WAVES) == {path.name for path in RTL.iterdir() if path.is_dir()} - {"gen", "ecp5"}
    for room, make in waves.WAVES.items():
        bench = ROOT / "cocotb_tests" / f"{make().bench.replace('.', '/')}.py"
        assert f'check_diagram(dut, "{room}", ' in bench.read_text()
        assert f"img/waves-{room}.svg" in (DOCS / "board.md").read_text()


def test_every_entry_of_a_public_docstring_is_one_name_and_what_it_is() -> None:
    """Lines that go on with an entry are indented further: otherwise the page of the API cuts them off; of two names in
    an entry it makes a type of the second."""
    import signum

    entries: list[str] = []
    for name in signum.__all__:
        thing = getattr(signum, name)
        members = [vars(thing)[m] for m in vars(thing) if not m.startswith("_")] if inspect.isclass(thing) else []
        for one in (thing, *members):
            doc = inspect.getdoc(one) or ""
            for section in re.findall(r"^(?:Args|Attributes|Raises):\n((?: {4}.*\n?)+)", doc, re.M):
                entries += re.findall(r"^ {4}(\S.*)$", section, re.M)
    assert len(entries) > 100
    assert not [entry for entry in entries if not re.match(r"[\w.]+: \S", entry)]


def test_readme_is_short_and_its_links_lead_somewhere() -> None:
    text = (ROOT / "README.md").read_text()
    links = re.findall(r"\]\(([^)#]+)\)", text)
    assert len(text.split()) <= README_WORDS
    assert links and not [link for link in links if not (ROOT / link).exists()]
