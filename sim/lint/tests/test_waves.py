# SPDX-License-Identifier: Apache-2.0
"""The saved views of waveforms name ports that exist, one view for each room."""

import re

import pytest

from sim.toolchain import ROOT, RTL

ROOMS = sorted(path.name for path in RTL.iterdir() if path.is_dir() and path.name not in ("gen", "ecp5"))


@pytest.mark.parametrize("room", ROOMS)
def test_the_view_names_ports(room: str) -> None:
    named = re.findall(r"^variable_add (\w+)\.(\w+)$", (ROOT / "waves" / f"{room}.sucl").read_text(), re.MULTILINE)
    (module,) = {module for module, _ in named}
    text = (RTL / room / f"{module}.sv").read_text()
    ports = set(re.findall(r"\b(\w+_[io])\b", text[:text.index("\n);")]))
    assert len(named) > 5 and {port for _, port in named} == ports
