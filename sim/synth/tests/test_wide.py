# SPDX-License-Identifier: Apache-2.0
"""Sites of the wide dense engine's memories, and its table."""

from __future__ import annotations

from typing import Any

import pytest

from golden.cycle.dense.wide import COLUMNS
from sim.synth.floorplan import SITES
from sim.synth.wide import MOST_GROUPS, place_memories, rate, snake, table

AT = {site.bel: (site.x, site.y) for site in SITES["DP16KD"]}
FAR = 26
"""Tiles between the first block RAMs of groups that follow one another, at most: from one row to the next."""


def _memories(groups: int) -> dict[str, Any]:
    name = "g_group[{}].u_group.u_memory.u_ram.g_block[{}].u_block.u_bram"
    return {name.format(g, n): {"type": "DP16KD"} for g in range(groups) for n in range(COLUMNS)}


@pytest.mark.parametrize("groups", [1, 13, 14, 40, MOST_GROUPS])
def test_neighbours_lie_side_by_side(groups: int) -> None:
    cells = _memories(groups)
    assert place_memories(cells) == groups * COLUMNS
    sites = [cell["attributes"]["BEL"] for cell in cells.values()]
    assert len(set(sites)) == len(sites) and set(sites) <= set(AT)
    for here, there in zip(sites[::COLUMNS], sites[COLUMNS::COLUMNS], strict=False):
        assert sum(abs(a - b) for a, b in zip(AT[here], AT[there], strict=True)) <= FAR
    assert len(snake(groups)) == groups


def test_too_many_memories_and_others_are_refused() -> None:
    with pytest.raises(ValueError, match="212 block RAMs: the device has 208"):
        place_memories(_memories(MOST_GROUPS + 1))
    with pytest.raises(ValueError, match="u_other is not the memory of a group"):
        place_memories({"u_other": {"type": "DP16KD"}})


def test_table() -> None:
    """Engines by their lanes; the slowest seed decides; without a clock there is no rate."""
    assert rate(128, 200.0) == 102.4
    entry = {"lut4": 1, "ff": 2, "ebr": 3}
    lines = table({"128": {**entry, "routed_mhz": {}}, "16": {**entry, "routed_mhz": {"1": 200.0, "2": 190.0}}})
    assert [line.split()[0] for line in lines.splitlines()] == ["lanes", "16", "128"]
    assert lines.splitlines()[1].endswith("12.2") and lines.splitlines()[2].endswith("-")
