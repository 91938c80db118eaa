"""Retiming of the generated register block: a block of another form is refused, not half changed."""

import pytest

from sim.registers.retime import retimed
from sim.toolchain import RTL


def test_other_form_is_refused() -> None:
    """The committed block has its registers already; what they do, `test_control` checks clock by clock."""
    with pytest.raises(ValueError, match="has 0 places"):
        retimed((RTL / "gen" / "slog_csr.sv").read_text())
