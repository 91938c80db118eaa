# SPDX-License-Identifier: Apache-2.0
"""The coefficients for designs without a host: the committed file is current, and holds what the kernels are."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from golden import coefs
from golden.log import kernels


def test_file_is_current(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert coefs.main(["--check"]) == 0
    committed = coefs.TARGET.read_text()
    for name in ("TARGET", "ROOT"):
        monkeypatch.setattr(coefs, name, tmp_path / "coefs.svh" if name == "TARGET" else tmp_path)
    assert coefs.main(["--check"]) == 1
    assert "stale: coefs.svh" in capsys.readouterr().err
    assert coefs.main([]) == 0
    assert coefs.TARGET.read_text() == committed
    assert coefs.main(["--check"]) == 0
    coefs.TARGET.write_text("other")
    assert coefs.main(["--check"]) == 1


@pytest.mark.parametrize("radius", [8, 16])
def test_table_holds_the_kernels(radius: int) -> None:
    text = coefs.sv_coefs()
    for index, name in enumerate(("g", "g2")):
        body = text.split(f"slog_{name}_radius{radius}(")[1].split("endfunction")[0]
        entries = re.findall(r"(\d+): return \{([^}]*)\}", body)
        assert [int(quarters) for quarters, _ in entries] == list(range(4, 17))
        for quarters, taps in entries:
            values = [(-1 if minus else 1) * int(size) for minus, size in re.findall(r"(-?)18'sd(\d+)", taps)]
            assert tuple(reversed(values)) == kernels(int(quarters) / 4, radius)[index]
