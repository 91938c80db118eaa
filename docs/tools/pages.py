# SPDX-License-Identifier: Apache-2.0
"""MkDocs hook: the pages that are made from the code, so that they cannot differ from it.

The command line from the commands' own options, every CSV's columns from `signum.tables.schemas`, the registers from
the generated map, PeakRDL's page beside them; and pages that the navigation does not name enter it by
their headings.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Iterator
from enum import EnumType
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PAGES = ROOT / "out" / "regs"
SUFFIXES = {"_px": "pixels", "_m": "metres", "_deg": "degrees", "_s": "seconds"}
UNITS = {
    "frame": "name", "frame_a": "name", "frame_b": "name", "name": "name", "feature": "number", "object": "number",
    "kind": "word",
    "state": "word", "reason": "phrase, empty if accepted", "method": "word", "error": "word", "unit": "word",
    "section": "word", "figure": "phrase", "relation": "sign", "score": "matching fraction, 0 to 1",
    "margin": "matching fraction", "valid": "0 or 1", "accepted": "0 or 1", "sharp": "0 or 1", "met": "0 or 1",
    "camera": "word", "used": "0 or 1", "corners": "number", "reference": "number",
    "scale": "ratio", "confidence": "0 to 100", "agreed": "windows", "tried": "windows",
    "windows": "number", "direct": "features", "links": "measurements", "pairs": "number",
    "component": "number", "epsg": "code",
    **dict.fromkeys(("rmse", "mean", "median", "std", "min", "max"), "of column unit"),
    **dict.fromkeys(("measured", "bound"), "as the figure names"),
}
"""Units of the columns whose names do not end in one; for `DRIFT`, `valid` is a number of features."""
EXCEPTIONS = {("DRIFT", "valid"): "features", ("NAVIGATE", "confidence"): "0 to 1"}


def unit(table: str, column: str) -> str:
    """The unit of a table's column.

    Raises:
        KeyError: for a column that has none: add it to UNITS.
    """
    if (table, column) in EXCEPTIONS:
        return EXCEPTIONS[table, column]
    if column in UNITS:
        return UNITS[column]
    suffix = next((s for s in SUFFIXES if column.endswith(s)), None)
    if suffix is None:
        raise KeyError(f"column {column!r} of {table} has no unit: add it to UNITS in docs/tools/pages.py")
    return SUFFIXES[suffix]


def schemas() -> Iterator[tuple[str, tuple[str, ...], str]]:
    """Name, columns and description of every table, in the order of the source."""
    from signum.tables import schemas as module

    body = ast.parse(inspect.getsource(module)).body
    for node, after in pairwise(body):
        if (isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and isinstance(after, ast.Expr)
                and isinstance(after.value, ast.Constant)):
            name = node.targets[0].id
            yield name, getattr(module, name), inspect.cleandoc(str(after.value.value))


def tables_page() -> str:
    """Markdown of every table's columns."""
    from signum.tables import schemas as module

    about = inspect.cleandoc(str(module.__doc__)).partition("\n")[2].strip()
    parts = ["# Tables", "The columns of every CSV file, with their units. The first line of a file names its columns; "
             "a row is written and flushed as a whole. This page is made from `sw/signum/tables/schemas.py`.", about]
    for name, columns, text in schemas():
        file, _, rest = text.partition(":")
        heading = file if file.startswith("`") and "\n" not in file and len(file) < 70 else f"Columns `{name}`"
        parts += [f"## {heading}", _sentence(rest if heading == file else text), "| Column | Unit |\n| --- | --- |\n"
                  + "\n".join(f"| `{c}` | {unit(name, c)} |" for c in columns)]
    return "\n\n".join(parts) + "\n"


def _sentence(text: str) -> str:
    return text.strip()[:1].upper() + text.strip()[1:]


def commands_page() -> str:
    """Markdown of every command's help."""
    import typer

    from signum.commands.cli import application

    top: Any = typer.main.get_command(application())
    parts = ["# Command line", "After `make setup` the command is `.venv/bin/signum`. This page is made from the help "
             "of the commands: `signum COMMAND --help` prints the same. Errors are one line on standard error, with "
             "status 1; an interrupt ends a command with status 130 and keeps what was finished."]
    for name, command in sorted(top.commands.items()):
        parts += [f"## signum {name}", _plain(command.help)]
        arguments = [p for p in command.params if p.param_type_name == "argument"]
        options = [p for p in command.params if p.param_type_name == "option" and not p.hidden]
        usage = " ".join(_upper(p) if p.required else f"[{_upper(p)}]" for p in arguments)
        parts.append(f"```text\nsignum {name} [OPTIONS] {usage}".rstrip() + "\n```")
        rows = [f"| `{_upper(p)}` | {_cell(p.help)} | |" for p in arguments]
        rows += [f"| {', '.join(f'`{o}`' for o in (*p.opts, *p.secondary_opts))} | {_cell(p.help)} | {_default(p)} |"
                 for p in options]
        if rows:
            parts.append("\n".join(["| Option | Meaning | Default |", "| --- | --- | --- |", *rows]))
    return "\n\n".join(parts) + "\n"


def _plain(text: str | None) -> str:
    return inspect.cleandoc(text or "")


def _upper(argument: Any) -> str:
    return str(argument.name).upper()


def _cell(text: str | None) -> str:
    return " ".join((text or "").split()).replace("|", "\\|")


def _default(option: Any) -> str:
    shown = option.show_default
    value = option.default
    if isinstance(shown, str):
        return shown
    if value is None or shown is False or callable(value):
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"`{getattr(value, 'value', value)}`"


def registers_table(dense: bool = False) -> str:
    """Markdown of every register of all boards, or of the dense engine: address, name, fields with their bits."""
    from sim.registers.map import dense_fields, fields

    found: dict[str, tuple[int, list[str]]] = {}
    for path, place in (dense_fields() if dense else fields()).items():
        register, _, name = path.rpartition(".")
        bits = f"{place.lsb + place.width - 1}:{place.lsb}" if place.width > 1 else f"{place.lsb}"
        found.setdefault(register, (place.address, []))[1].append(f"`{name}` [{bits}]")
    rows = [f"| `0x{address:03x}` | `{name}` | {', '.join(names)} |" for name, (address, names)
            in sorted(found.items(), key=lambda item: item[1][0])]
    return "\n".join(["| Address | Register | Fields [bits] |", "| --- | --- | --- |", *rows])


SECTIONS = {
    "Boards": "open_board Board BoardError Identification FULL DENSE TINY Config",
    "Jobs and results": "Job grid run_jobs Result Status NO_SCORE locate_peaks Peak",
    "Dense passes": "DenseJob DensePass DenseResult",
    "Frames": "open_source Source Frame read_picture Fit",
    "Measurements": "Measurer View Query Measurement Reason Rules",
    "Flow, range, tracks": "measure_flow FlowField measure_range RangeMap Tracker TrackPoint TrackSettings",
    "Flow and range at every pixel": "measure_dense_flow DenseFlowRules measure_dense_range DenseStereoRules",
    "What moves by itself": "segment_moving Moving MovingObject MovingRules Background",
    "Calibration": "open_lens Lens open_rig Rig Rectifier StereoGeometry read_mono read_stereo",
    "Mosaics": "Registrar Registration RegistrationLimits Similarity Survey SurveySettings",
    "Hover": "StationMeter Reading Level MavlinkSink",
    "Following": "Follower Target RangeEye MotionEye DenseEye",
    "Navigation": "Localiser LocaliseLimits Chart Place",
    "Errors": "SignumError SourceError",
}
"""The names of signum's face in the order in which a reader meets them."""


def api_page() -> str:
    """A directive of mkdocstrings for each name of signum's face, by what it is for; the values of enumerations.

    Raises:
        KeyError: if a name is in no section: add it to SECTIONS.
    """
    import signum

    missing = set(signum.__all__) - set(" ".join(SECTIONS.values()).split())
    if missing:
        raise KeyError(f"{', '.join(sorted(missing))}: add to SECTIONS in docs/tools/pages.py")
    parts = []
    for title, names in SECTIONS.items():
        parts.append(f"## {title}")
        for name in names.split():
            parts.append(f"::: {signum._HOME[name]}.{name}")
            thing = getattr(signum, name)
            if isinstance(thing, EnumType):
                values = ", ".join(f"`{key}` = {value.value!r}" for key, value in thing.__members__.items())
                parts.append(f"Values of `{name}`: {values}.")
    return "\n\n".join(parts)


def on_config(config: Any) -> Any:
    """Make the project importable, and add the pages that the navigation does not name."""
    sys.path[:0] = [str(ROOT / "sw"), str(ROOT)]  # MkDocs undoes what a hook does to it while loading
    named = str(config.nav)
    config.nav[-1:-1] = [{_title(path): path.name} for path in sorted((ROOT / "docs").glob("*.md"))
                         if f"'{path.name}'" not in named]
    return config


def _title(path: Path) -> str:
    """A page's first heading."""
    return next(line.lstrip("# ") for line in path.read_text().splitlines() if line.startswith("#"))


def on_files(files: Any, config: Any) -> Any:
    """Add the generated pages, and PeakRDL's page as it is."""
    from mkdocs.structure.files import File

    for path, text in (("reference/tables.md", tables_page()), ("reference/commands.md", commands_page())):
        files.append(File.generated(config, path, content=text))
    from sim.registers.generate import pages

    pages(PAGES)
    for page in PAGES.glob("*/index.html"):  # no foreign scripts
        page.write_text(re.sub(r"<script async src=\"https://[^>]*></script>", "", page.read_text()))
    for path in sorted(p for p in PAGES.rglob("*") if p.is_file()):
        files.append(File.generated(config, f"reference/regs/{path.relative_to(PAGES)}", abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Put the table of registers and the list of names into their pages."""
    for mark, make in (("{{ registers }}", registers_table), ("{{ dense registers }}", partial(registers_table, True)),
                       ("{{ api }}", api_page)):
        if mark in markdown:
            markdown = markdown.replace(mark, make())
    return markdown
