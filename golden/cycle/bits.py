# SPDX-License-Identifier: Apache-2.0
"""Port values as Python integers: packed vectors, two's complement, undefined values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from golden.cycle.model import Inputs
from golden.params import COEF_BITS


def pack(values: Sequence[int | None], width: int) -> int | None:
    """Fields of `width` bits in one word, the first lowest; None if any is undefined."""
    word = 0
    for i, v in enumerate(values):
        if v is None:
            return None
        word |= (v & ((1 << width) - 1)) << (i * width)
    return word


def pack_coefs(kernel: Sequence[int]) -> int:
    """The coefficients of a symmetric kernel as a port carries them: the centre in the lowest COEF_BITS bits."""
    return or_zero(pack(kernel, COEF_BITS))


def signed(word: int, width: int) -> int:
    """Two's complement value of the low `width` bits."""
    word &= (1 << width) - 1
    return word - (1 << width) if word >> (width - 1) else word


def unpack(word: int, width: int, count: int) -> list[int]:
    """`count` signed fields of `width` bits, the lowest first."""
    return [signed(word >> (i * width), width) for i in range(count)]


def or_zero(value: int | None) -> int:
    """`value`, or 0 where it is undefined: for a receiver that ignores undefined values."""
    return value or 0


def all_or_zero(values: Mapping[str, int | None]) -> Inputs:
    """`values` with 0 for each undefined one: inputs of a model that ignores undefined values."""
    return {name: or_zero(value) for name, value in values.items()}
