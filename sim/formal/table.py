# SPDX-License-Identifier: Apache-2.0
"""The tables of proofs and modules in `docs/verification.md`: `python -m sim.formal.table` writes them anew."""

from __future__ import annotations

import re
from pathlib import Path

from golden.params import CONFIGS
from sim.formal.proofs import PROOFS, REASONS, Proof
from sim.toolchain import listed_sources, top_of, wide_sources

PAGE = Path(__file__).parents[2] / "docs" / "verification.md"
BEGIN, END = "<!-- proofs: begin -->", "<!-- proofs: end -->"


def listed_modules() -> list[str]:
    """Modules in `rtl/files.f`, in its order, and those of no board, without packages and generated files."""
    paths = [*map(Path, listed_sources()), *wide_sources()]
    modules = [path.stem for path in paths if path.parts[0] != "gen" and not path.stem.endswith("_pkg")]
    return [module for module in modules if module != "{top}"] + list(dict.fromkeys(map(top_of, CONFIGS)))


def proof_row(proof: Proof) -> str:
    """One line of the table of proofs."""
    values = ", ".join(f"{name} {value}" for name, value in proof.parameters.items())
    what = f"`{proof.top}`" + (f": {values}" if values else "")
    assumed = ", ".join(f"`{name.lstrip('*')}`" for name in proof.assumed) or "-"
    return (f"| `{proof.name}` | {what} | {proof.mode} | {proof.depth} | {proof.reset or '-'} | "
            f"{'yes' if proof.quick else 'no'} | {assumed} |")


def module_row(module: str) -> str:
    """One line of the table of modules: its proofs, or the reason why it has none.

    Raises:
        KeyError: if the module has neither.
    """
    names = [f"`{proof.name}`" for proof in PROOFS if proof.top == module]
    return f"| `{module}` | {', '.join(names) if names else REASONS[module]} |"


def tables() -> str:
    """Both tables, in Markdown."""
    return "\n".join([
        "| proof | module, parameters | kind | depth | reset, clocks | quick | assumed of the user |",
        "| --- | --- | --- | --- | --- | --- | --- |", *(proof_row(proof) for proof in PROOFS), "",
        "| module | proofs, or why it has none |", "| --- | --- |",
        *(module_row(module) for module in listed_modules())])


def page() -> str:
    """The page with its tables as they should be."""
    between = re.compile(f"{re.escape(BEGIN)}.*{re.escape(END)}", re.DOTALL)
    return between.sub(lambda _: f"{BEGIN}\n\n{tables()}\n\n{END}", PAGE.read_text())


if __name__ == "__main__":
    PAGE.write_text(page())
