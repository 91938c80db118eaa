# SPDX-License-Identifier: Apache-2.0
"""Retiming of the generated register block: a block of another form is refused, not changed in part."""

import pytest

from sim.registers.retime import retimed
from sim.toolchain import RTL


def test_other_form_is_refused() -> None:
    """The committed block is retimed already; `test_control` checks its behaviour on every clock."""
    with pytest.raises(ValueError, match="has 0 places"):
        retimed((RTL / "gen" / "slog_csr.sv").read_text())
