# SPDX-License-Identifier: Apache-2.0
"""Timing of `slog_operands` and `slog_array`, as in rtl/array/slog_array_pkg.sv.

All counts are clocks from the one in which the step of `slog_operands` is valid; `group_bits` is a power of two.
"""

from __future__ import annotations

OPERAND_LATENCY = 9
"""Step to the operand outputs."""
WRITE_LATENCY = 1
"""Write of a word to the first step that may read it."""
REUSE_CLOCKS = 4
"""Step to the first write that may overwrite a word the step reads."""


def popcount_levels(group_bits: int) -> int:
    """Levels of the popcount tree: both groups together hold 2**(levels + 1) bits."""
    return (group_bits - 1).bit_length()


def score_bits(group_bits: int) -> int:
    """Values of a count of mismatches, 0..(2*group_bits)**2."""
    return 2 * popcount_levels(group_bits) + 3


def core_latency(group_bits: int) -> int:
    """Operands at `slog_array` to the first mismatch of the pass that ends with them.

    Hop 1, XOR 1, tree levels, accumulator 1 + `score_bits` (bit 0 first), lane selection 3.
    """
    return popcount_levels(group_bits) + score_bits(group_bits) + 6


def array_latency(group_bits: int) -> int:
    """Last step of a pass to its first mismatch."""
    return OPERAND_LATENCY + core_latency(group_bits)


def hold_clocks(group_bits: int, lanes: int) -> int:
    """Clocks for which `slog_array` must keep moving after one with valid operands."""
    return core_latency(group_bits) + lanes


def drain_clocks(group_bits: int, lanes: int) -> int:
    """Clocks without a valid step after which the mask may change."""
    return OPERAND_LATENCY + lanes + popcount_levels(group_bits)
