"""The bench itself: broken RTL must fail the comparison, and the message must name the place."""

from pathlib import Path

import pytest

from sim.runner import simulate
from sim.toolchain import RTL

BREAKS = {
    "late pointer": ("head_q <= (head_q == Last)", "head_q <= (head_q + 1'b1 == Last)", r"clock \d+: out_data_o is"),
    "off by one": ("level_q == LevelW'(Depth - 1)));", "level_q == LevelW'(Depth - 2)));", r"clock \d+: in_ready_o is"),
    "lost word": ("some_q <= push ||", "some_q <= (push && !pop) ||", r"clock \d+: \w+ is"),
}


@pytest.mark.parametrize("name", BREAKS)
def test_broken_rtl_is_found(name: str, tmp_path: Path) -> None:
    """One break of the FIFO at a time; the unbroken one passes in `test_fifo.py`."""
    right, wrong, message = BREAKS[name]
    source = (RTL / "slog_fifo.sv").read_text()
    assert source.count(right) == 1
    broken = tmp_path / "slog_fifo.sv"
    broken.write_text(source.replace(right, wrong))
    with pytest.raises(AssertionError, match=message):
        simulate("slog_fifo", [broken], "cocotb_tests.tb_fifo", {"Width": 8, "Depth": 4})
