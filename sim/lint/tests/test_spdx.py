# SPDX-License-Identifier: Apache-2.0
"""The licence's line is found, added once, in the right place, and left out of comparisons."""

from pathlib import Path

import pytest

from sim.lint import spdx, tree
from sim.toolchain import ROOT


@pytest.mark.parametrize(("name", "before", "after"), [
    ("a.py", '"""Doc."""\n', '# SPDX-License-Identifier: Apache-2.0\n"""Doc."""\n'),
    ("a.sh", "#!/bin/sh\nls\n", "#!/bin/sh\n# SPDX-License-Identifier: Apache-2.0\nls\n"),
    ("a.core", "CAPI=2:\nname: a\n", "CAPI=2:\n# SPDX-License-Identifier: Apache-2.0\nname: a\n"),
    ("a.sv", "module a;\n", "// SPDX-License-Identifier: Apache-2.0\nmodule a;\n"),
    ("__init__.py", "", "# SPDX-License-Identifier: Apache-2.0\n"),
])
def test_the_line_is_added_and_left_out(name: str, before: str, after: str, tmp_path: Path,
                                        monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spdx, "ROOT", tmp_path)
    file = tmp_path / name
    file.write_text(before)
    spdx.add(file)
    assert file.read_text() == after and spdx.without(after) == before


def test_a_file_without_it_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    bare, good = tmp_path / "bare.py", tmp_path / "good.py"
    bare.write_text("x = 1\n")
    good.write_text("# SPDX-License-Identifier: Apache-2.0\n")
    monkeypatch.setattr(spdx, "ROOT", tmp_path)
    monkeypatch.setattr(spdx, "sources", lambda: [bare, good])
    assert spdx.missing() == [bare]


def test_every_source_has_it() -> None:
    assert spdx.missing() == []
    assert len(spdx.sources()) > 400


def test_without_git_the_same_files_are_the_projects(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    listed = tree.project_files()
    assert ROOT / "README.md" in listed
    monkeypatch.setenv("PATH", str(tmp_path))
    assert tree.project_files() == listed
