# SPDX-License-Identifier: Apache-2.0
"""The file lists for other tools hold the files of `rtl/files.f`, in its order, and can be read by those tools."""

import importlib.util
import subprocess
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from golden.coefs import sv_coefs
from golden.log import kernels
from golden.params import CONFIGS
from sim.lint import core, lists
from sim.testbench.vectors import VECTORS, vectors
from sim.toolchain import ROOT, RTL, rtl_sources, top_of, verilator_env


def _yaml(path: Path) -> Any:
    return YAML(typ="safe").load(path.read_text().removeprefix("CAPI=2:\n"))


def test_no_list_is_stale() -> None:
    assert lists.stale() == []
    assert (RTL / "gen" / "slog_coefs.svh").read_text() == sv_coefs()
    assert {name: (VECTORS / name).read_text() for name in vectors()} == vectors()


@pytest.mark.parametrize("config", CONFIGS)
def test_verilator_reads_the_list_from_any_folder(config: str, tmp_path: Path) -> None:
    listed = [RTL / line for line in (RTL / f"{config}.f").read_text().splitlines() if line.endswith(".sv")]
    assert listed == rtl_sources(config)
    done = subprocess.run(["verilator", "--lint-only", "-F", RTL / f"{config}.f", "--top-module",
                           top_of(config)], cwd=tmp_path, env=verilator_env(), capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0 and "Warning" not in done.stderr, done.stderr


OTHERS = "not(any(dense, tiny, tiny_dense))"
"""Bender's expression for the board that is taken when no target names one."""


@pytest.mark.parametrize("config", CONFIGS)
def test_bender_has_every_file_in_order(config: str) -> None:
    manifest = _yaml(ROOT / "Bender.yml")
    wanted = OTHERS if config == "full" else config
    assert {group.get("target", wanted) for group in manifest["sources"]} == {OTHERS, *CONFIGS} - {"full"}
    files = [ROOT / file for group in manifest["sources"] if group.get("target", wanted) == wanted
             for file in group["files"]]
    assert files == rtl_sources(config) and manifest["package"]["name"] == "signum"
    assert all((ROOT / folder).is_dir() for folder in manifest["export_include_dirs"])


def test_core_has_every_file_in_order() -> None:
    described = _yaml(ROOT / "signum.core")
    for config in CONFIGS:
        target = "lint" if config == "full" else f"lint_{config}"
        assert described["targets"][target]["toplevel"] == top_of(config)
        files = [ROOT / file for fileset in described["targets"][target]["filesets"]
                 for file in described["filesets"][fileset]["files"] if isinstance(file, str)]
        assert files == rtl_sources(config)
    everything = [next(iter(file)) if isinstance(file, dict) else file
                  for fileset in described["filesets"].values() for file in fileset["files"]]
    assert all((ROOT / file).is_file() for file in everything)


def test_coefficients_are_the_kernels() -> None:
    """As an independent reading of the header: radius 16, sigma 2.25."""
    text = (RTL / "gen" / "slog_coefs.svh").read_text()
    for name, half in zip(("g", "g2"), kernels(2.25, 16), strict=True):
        body = text[text.index(f"slog_{name}_radius16("):]
        entry = body[body.index("    9: return {"):]
        taps = entry[entry.index("{") + 1:entry.index("}")].replace("\n", "").split(",")
        values = [int(tap.strip().replace("18'sd", "")) for tap in taps]
        assert values == list(reversed(half))


@pytest.mark.slow
@pytest.mark.skipif(importlib.util.find_spec("fusesoc") is None, reason="FuseSoC is not installed: make setup")
def test_fusesoc_simulates_the_signs_of_a_frame() -> None:
    done = core.run("sim")
    assert done.returncode == 0 and "PASS: 216 words" in done.stdout, done.stdout[-4000:]
