"""Cycle model of `slog_axil` and the generated `slog_csr`: AXI4-Lite side, storage, read path."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol


class FieldPlace(Protocol):
    """Place of a field: byte address of its register, lowest bit, width (`sim.registers.map.Field`)."""

    @property
    def address(self) -> int: ...
    @property
    def lsb(self) -> int: ...
    @property
    def width(self) -> int: ...


@dataclass(frozen=True)
class Request:
    """An access: its byte address, and the data and byte strobes of a write."""

    address: int
    is_write: bool
    data: int = 0
    strobes: int = 0


class CsrModel:
    """Registers behind AXI4-Lite.

    Args:
        fields: every field by dotted path.
        stored: fields the host writes and the block keeps, with their reset values.
        cleared: stored fields that hardware sets and the host clears by writing 1.
        waits: field of the waiting register, whose reads wait until the hardware is ready.
    """

    INPUTS = ("s_axil_awaddr", "s_axil_awprot", "s_axil_awvalid", "s_axil_wdata", "s_axil_wstrb", "s_axil_wvalid",
              "s_axil_bready", "s_axil_araddr", "s_axil_arprot", "s_axil_arvalid", "s_axil_rready")
    OUTPUTS = ("s_axil_awready", "s_axil_wready", "s_axil_bresp", "s_axil_bvalid", "s_axil_arready", "s_axil_rdata",
               "s_axil_rresp", "s_axil_rvalid")

    def __init__(self, fields: Mapping[str, FieldPlace], stored: Mapping[str, int], cleared: tuple[str, ...],
                 waits: str) -> None:
        self.fields, self.stored, self.cleared = fields, dict(stored), cleared
        self.pulses = tuple(name for name in fields if name.endswith((".go", ".abort_0", ".abort_1")))
        self.waits = fields[waits].address
        self.by_address: dict[int, list[str]] = {}
        for name, place in fields.items():
            self.by_address.setdefault(place.address, []).append(name)
        self.rdata: int | None = None
        self.reset()

    def reset(self) -> None:
        """State after reset."""
        self.value = {**self.stored, **dict.fromkeys(self.pulses, 0), **dict.fromkeys(self.cleared, 0)}
        self.fresh = True  # nothing is accepted yet
        self.ar: int | None = None
        self.aw: int | None = None
        self.w: tuple[int, int] | None = None
        self.ar_settled = self.aw_settled = self.w_settled = False  # held since the clock before
        self.under_way, self.read_last = False, False
        self.begun: Request | None = None  # the access that begins in this clock
        self.asked: Request | None = None  # the access that began in the clock before
        self.request: Request | None = None  # the request at the register block
        self.parted: Request | None = None  # the request of the clock before
        self.found: Request | None = None  # the request of two clocks before
        self.decoded: Request | None = None  # the request of three clocks before, at its register
        self.read: tuple[int | None] | None = None  # the value read by the request of four clocks before
        self.read2: tuple[int | None] | None = None  # the value read by the request of five clocks before
        self.answer: tuple[int | None] | None = None  # the value the read path returns in this clock
        self.bvalid, self.rvalid = False, False

    def chosen(self, wait: bool) -> Request | None:
        """The access that begins in the next clock; `wait`: the waiting register is not ready."""
        if self.under_way:
            return None
        read = None
        if self.ar is not None and self.ar_settled and not (wait and self.ar & ~3 == self.waits):
            read = Request(self.ar & ~3, False)
        write = None
        if self.aw is not None and self.aw_settled and self.w is not None and self.w_settled:
            write = Request(self.aw & ~3, True, *self.w)
        if read and write:
            return write if self.read_last else read
        return read or write

    @property
    def taken(self) -> bool:
        """The waiting register is read in this clock."""
        return self.decoded is not None and not self.decoded.is_write and self.decoded.address == self.waits

    def outputs(self) -> dict[str, int | None]:
        """Outputs of this clock: all come from registers."""
        return {
            "s_axil_arready": int(self.ar is None and not self.fresh),
            "s_axil_awready": int(self.aw is None and not self.fresh),
            "s_axil_wready": int(self.w is None and not self.fresh), "s_axil_bvalid": int(self.bvalid),
            "s_axil_rvalid": int(self.rvalid), "s_axil_rdata": self.rdata, "s_axil_bresp": 0, "s_axil_rresp": 0,
        }

    def edge(self, i: Mapping[str, int], status: Mapping[str, int | None], events: Mapping[str, int],
             wait: bool) -> None:
        """Take the clock edge.

        Args:
            i: inputs.
            status: values of the fields hardware drives, None if undefined.
            events: whether hardware sets each `cleared` field.
            wait: the waiting register is not ready.
        """
        if self.answer is not None:
            self.rdata = self.answer[0]
        if i["rst_i"]:
            self.reset()
            return
        request, chosen = self.decoded, self.chosen(wait)
        ended = (self.bvalid and i["s_axil_bready"]) or (self.rvalid and i["s_axil_rready"])
        wrote = request is not None and request.is_write
        self.rvalid = self.answer is not None or (self.rvalid and not i["s_axil_rready"])
        self.bvalid = wrote or (self.bvalid and not i["s_axil_bready"])
        self.answer, self.read2 = self.read2, self.read
        self.read = None if request is None or wrote else (self._read(request.address, status),)
        self._store(request if wrote else None, events)
        begun = self.begun
        self.decoded, self.found, self.parted = self.found, self.parted, self.request
        self.request, self.asked, self.begun = self.asked, begun, chosen
        if begun is not None:
            self.read_last = not begun.is_write
        if chosen is not None:
            self.under_way = True
        elif ended:
            self.under_way = False

        # The requests that wait, and new ones where none does.
        ar, aw, w = self.ar, self.aw, self.w
        self.ar_settled = ar is not None and not (begun is not None and not begun.is_write)
        self.aw_settled = aw is not None and not (begun is not None and begun.is_write)
        self.w_settled = w is not None and not (begun is not None and begun.is_write)
        if begun is not None and begun.is_write:
            self.aw = self.w = None
        elif begun is not None:
            self.ar = None
        fresh, self.fresh = self.fresh, False
        if ar is None and i["s_axil_arvalid"] and not fresh:
            self.ar = i["s_axil_araddr"]
        if aw is None and i["s_axil_awvalid"] and not fresh:
            self.aw = i["s_axil_awaddr"]
        if w is None and i["s_axil_wvalid"] and not fresh:
            self.w = (i["s_axil_wdata"], i["s_axil_wstrb"])

    def _store(self, request: Request | None, events: Mapping[str, int]) -> None:
        """Apply a write and the events of the hardware to the fields."""
        pulses = dict.fromkeys(self.pulses, 0)
        if request is not None:
            enable = sum(0xFF << 8 * b for b in range(4) if request.strobes >> b & 1)
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
