# SPDX-License-Identifier: Apache-2.0
"""Cycle model of a generated register block, and of `slog_csr` behind `slog_axil`: storage and read path."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from golden.cycle.control.axil import AxilModel, Request


class FieldPlace(Protocol):
    """Place of a field: byte address of its register, lowest bit, width (`sim.registers.map.Field`)."""

    @property
    def address(self) -> int: ...
    @property
    def lsb(self) -> int: ...
    @property
    def width(self) -> int: ...


class RegistersModel:
    """A generated register block: storage, and the way of a request through it.

    Args:
        fields: every field by dotted path.
        stored: fields the host writes and the block keeps, with their reset values.
        cleared: stored fields that hardware sets and the host clears by writing 1.
        pulses: fields that are 1 for a clock after 1 was written to them.
    """

    def __init__(self, fields: Mapping[str, FieldPlace], stored: Mapping[str, int], cleared: tuple[str, ...],
                 pulses: tuple[str, ...]) -> None:
        self.fields, self.stored, self.cleared, self.pulses = fields, dict(stored), cleared, pulses
        self.by_address: dict[int, list[str]] = {}
        for name, place in fields.items():
            self.by_address.setdefault(place.address, []).append(name)
        self._reset()

    def _reset(self) -> None:
        self.value = {**self.stored, **dict.fromkeys(self.pulses, 0), **dict.fromkeys(self.cleared, 0)}
        self.parted: Request | None = None  # passed on 1 clock before: its address is split
        self.found: Request | None = None  # passed on 2 clocks before: its register is found
        self.decoded: Request | None = None  # passed on 3 clocks before: it reaches its register
        self.read: tuple[int | None] | None = None  # value read in the clock before, when it was in `decoded`
        self.read2: tuple[int | None] | None = None  # value read 2 clocks before
        self.answer: tuple[int | None] | None = None  # value read 3 clocks before, which the read path returns now

    @property
    def wrote(self) -> bool:
        """Whether a write is carried out in this clock."""
        return self.decoded is not None and self.decoded.is_write

    def take(self, rst: int, incoming: Request | None, status: Mapping[str, int | None],
             events: Mapping[str, int]) -> None:
        """Take the clock edge.

        Args:
            rst: the block is in reset.
            incoming: the request that is passed on in this clock.
            status: values of the fields hardware drives, None if undefined.
            events: whether hardware sets each `cleared` field.
        """
        if rst:
            self._reset()
            return
        request, wrote = self.decoded, self.wrote
        self.answer, self.read2 = self.read2, self.read
        self.read = None if request is None or wrote else (self._read(request.address, status),)
        self._store(request if wrote else None, events)
        self.decoded, self.found, self.parted = self.found, self.parted, incoming

    def _store(self, request: Request | None, events: Mapping[str, int]) -> None:
        """Apply a write and the events of the hardware to the fields."""
        pulses = dict.fromkeys(self.pulses, 0)
        if request is not None:
            enable = request.enable
            for name in self.by_address.get(request.address, []):
                place = self.fields[name]
                mask = (1 << place.width) - 1
                new, bits = request.data >> place.lsb & mask, enable >> place.lsb & mask
                if name in pulses:
                    pulses[name] = self.value[name] & ~bits | new & bits
                elif name in self.cleared:
                    if not events[name]:
                        self.value[name] &= ~(new & bits)
                elif name in self.stored:
                    self.value[name] = self.value[name] & ~bits | new & bits
        self.value.update(pulses)
        for name in self.cleared:
            if events[name]:
                self.value[name] = 1

    def _read(self, address: int, status: Mapping[str, int | None]) -> int | None:
        word = 0
        for name in self.by_address.get(address, []):
            if name in self.pulses:
                continue
            place = self.fields[name]
            value = self.value[name] if name in self.value else status[name]
            if value is None:
                return None
            word |= (value & (1 << place.width) - 1) << place.lsb
        return word


class CsrModel(RegistersModel):
    """Registers behind AXI4-Lite.

    Args:
        fields: every field by dotted path.
        stored: fields the host writes and the block keeps, with their reset values.
        cleared: stored fields that hardware sets and the host clears by writing 1.
        waits: field of the waiting register, whose reads wait until the hardware is ready.
    """

    INPUTS, OUTPUTS = AxilModel.INPUTS, AxilModel.OUTPUTS

    def __init__(self, fields: Mapping[str, FieldPlace], stored: Mapping[str, int], cleared: tuple[str, ...],
                 waits: str) -> None:
        pulses = tuple(name for name in fields if name.endswith((".go", ".abort_0", ".abort_1")))
        super().__init__(fields, stored, cleared, pulses)
        self.waits = fields[waits].address
        self.axil = AxilModel(self.waits)

    @property
    def taken(self) -> bool:
        """Whether the waiting register is read in this clock."""
        return self.decoded is not None and not self.decoded.is_write and self.decoded.address == self.waits

    @property
    def passed(self) -> Request | None:
        """The request that is passed on in this clock."""
        return self.axil.request

    def outputs(self) -> dict[str, int | None]:
        """Outputs of this clock; all are registers."""
        return self.axil.outputs()

    def edge(self, i: Mapping[str, int], status: Mapping[str, int | None], events: Mapping[str, int],
             wait: bool, others: int = 0) -> None:
        """Take the clock edge.

        Args:
            i: inputs.
            status: values of the fields hardware drives, None if undefined.
            events: whether hardware sets each `cleared` field.
            wait: the waiting register is not ready.
            others: what a further register block returns in this clock.
        """
        incoming, answer = self.axil.request, self.answer
        if answer is not None and answer[0] is not None:
            answer = (answer[0] | others,)
        self.axil.edge(i, wait, self.wrote, answer)
        self.take(i["rst_i"], incoming, status, events)
