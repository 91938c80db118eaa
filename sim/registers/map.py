# SPDX-License-Identifier: Apache-2.0
"""The register maps as plain data, from the generated PyRAL layers: no address is written by hand."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple

from peakrdl_pyral_runtime.model.array import RALArray


class Field(NamedTuple):
    """The place of a field: byte address of its register, lowest bit, bits."""

    address: int
    lsb: int
    width: int

    @property
    def mask(self) -> int:
        """The field's bits within its register."""
        return ((1 << self.width) - 1) << self.lsb

    def pack(self, value: int) -> int:
        """`value` at the field's place; negative values in two's complement.

        Raises:
            ValueError: if it does not fit.
        """
        if not -(1 << self.width - 1) <= value < 1 << self.width:
            raise ValueError(f"{value} does not fit into {self.width} bits")
        return (value << self.lsb) & self.mask

    def unpack(self, word: int) -> int:
        """The field's unsigned value in a register's word."""
        return (word & self.mask) >> self.lsb


def _walk(node: Any, path: str) -> Iterator[tuple[str, Field]]:
    for child in node.children():
        members = child if isinstance(child, RALArray) else [child]
        for member in members:
            # The path's last part carries the index of an array's element.
            last = member.name if hasattr(member, "offset") else member.path.rpartition(".")[2]
            name = f"{path}.{last}" if path else last
            if hasattr(member, "offset"):
                yield name, Field(node.address, member.offset, member.width)
            else:
                yield from _walk(member, name)


@cache
def fields() -> dict[str, Field]:
    """Every field of the registers of all boards, by dotted path; array elements as `result.neighbour[0].even`."""
    return dict(_walk(import_module("sim.registers.gen.slog_csr").get_ral(), ""))


@cache
def dense_fields() -> dict[str, Field]:
    """The same of the registers that boards with a dense engine have besides: their paths begin with `dense.`."""
    return dict(_walk(import_module("sim.registers.gen.slog_dense_csr").get_ral(), ""))


@cache
def _all_fields() -> dict[str, Field]:
    return {**fields(), **dense_fields()}


def field(path: str) -> Field:
    """A field of either map.

    Raises:
        KeyError: if there is none of this path.
    """
    return _all_fields()[path]


def word(register: str, **values: int) -> int:
    """A register's word from its fields' values; fields not named are 0.

    Raises:
        KeyError: for an unknown field.
    """
    return sum(field(f"{register}.{name}").pack(value) for name, value in values.items())


def address(register: str) -> int:
    """Byte address of a register.

    Raises:
        KeyError: for an unknown register.
    """
    for name, place in _all_fields().items():
        if name.rpartition(".")[0] == register:
            return place.address
    raise KeyError(register)
