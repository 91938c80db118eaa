"""Packed vectors as Python integers: fields of a port, little end first."""

from __future__ import annotations

from collections.abc import Sequence

Bits = dict[str, int | None]



def pack(values: Sequence[int | None], width: int) -> int | None:
    """Fields of `width` bits in one word, the first lowest; None if any is undefined."""
    word = 0
    for i, v in enumerate(values):
        if v is None:
            return None
        word |= (v & ((1 << width) - 1)) << (i * width)
    return word



def signed(word: int, width: int) -> int:
    """Two's complement value of the low `width` bits."""
    word &= (1 << width) - 1
    return word - (1 << width) if word >> (width - 1) else word



def unpack(word: int, width: int, count: int) -> list[int]:
    """`count` signed fields of `width` bits, the lowest first."""
    return [signed(word >> (i * width), width) for i in range(count)]
