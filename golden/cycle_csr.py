"""Cycle model of the generated register block: its AXI4-Lite side, its storage, its read path."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

DEPTH = 3
"""Transactions under way at most, and responses held."""


class FieldPlace(Protocol):
    """Where a field lives: `sim.registers.Field`."""

    @property
    def address(self) -> int: ...
    @property
    def lsb(self) -> int: ...
    @property
    def width(self) -> int: ...


class CsrModel:
    """Registers behind AXI4-Lite.

    Args:
        fields: every field by dotted path.
        stored: fields the host writes and the block keeps, with their reset values.
        cleared: stored fields that hardware sets and the host clears by writing 1.
        waits: field whose reads the hardware answers in its own time.
    """

    INPUTS = ("s_axil_awaddr", "s_axil_awprot", "s_axil_awvalid", "s_axil_wdata", "s_axil_wstrb", "s_axil_wvalid",
              "s_axil_bready", "s_axil_araddr", "s_axil_arprot", "s_axil_arvalid", "s_axil_rready")
    OUTPUTS = ("s_axil_awready", "s_axil_wready", "s_axil_bresp", "s_axil_bvalid", "s_axil_arready", "s_axil_rdata",
               "s_axil_rresp", "s_axil_rvalid")

    def __init__(self, fields: Mapping[str, FieldPlace], stored: Mapping[str, int], cleared: tuple[str, ...],
                 waits: str) -> None:
        self.fields, self.stored, self.cleared = fields, dict(stored), cleared
        self.pulses = tuple(name for name in fields if name.endswith(".go"))
        self.waits = fields[waits].address
        self.by_address: dict[int, list[str]] = {}
        for name, place in fields.items():
            self.by_address.setdefault(place.address, []).append(name)
        self.reset()

    def reset(self) -> None:
        """State after reset."""
        self.value = {**self.stored, **dict.fromkeys(self.pulses, 0), **dict.fromkeys(self.cleared, 0)}
        self.prev_was_rd, self.in_flight, self.stall_write, self.pending = False, 0, False, False
        self.ar: int | None = None
        self.aw: int | None = None
        self.w: tuple[int, int] | None = None
        self.read_address = 0
        # Responses: is_write and data of each place; pointers count to 2 * DEPTH.
        self.is_write = [False] * DEPTH
        self.data: list[int | None] = [0] * DEPTH
        self.put, self.take = 0, 0
        self.retimed: int | None = 0
        self.retimed_done, self.retimed_ack = False, False

    def _dispatch(self) -> tuple[str, int] | None:
        """The request of this clock: what and where; it may still be stalled."""
        if self.in_flight >= DEPTH:
            return None
        write = self.aw is not None and self.w is not None
        if self.ar is not None and (not self.prev_was_rd or not write):
            return "read", self.ar & ~3
        if write:
            assert self.aw is not None
            return "write", self.aw & ~3
        return None

    def _accepted(self) -> tuple[str, int] | None:
        request = self._dispatch()
        if request is None or self.pending or (request[0] == "write" and self.stall_write):
            return None
        return request

    @property
    def external_read(self) -> bool:
        """The hardware is asked for the waiting register in this clock."""
        return self._accepted() == ("read", self.waits)

    def outputs(self) -> dict[str, int | None]:
        """Outputs of this clock: all come from registers."""
        accepted = self._accepted()
        kind = accepted[0] if accepted else ""
        full = self.put != self.take
        place = self.take % DEPTH
        return {
            "s_axil_arready": int(self.ar is None or kind == "read"),
            "s_axil_awready": int(self.aw is None or kind == "write"),
            "s_axil_wready": int(self.w is None or kind == "write"),
            "s_axil_bvalid": int(full and self.is_write[place]),
            "s_axil_rvalid": int(full and not self.is_write[place]),
            "s_axil_rdata": self.data[place],
            "s_axil_bresp": 0,
            "s_axil_rresp": 0,
        }

    def edge(self, i: Mapping[str, int], status: Mapping[str, int | None],
             events: Mapping[str, int], answer: int, answer_data: int | None) -> None:
        """Take the clock edge.

        Args:
            i: inputs.
            status: values of the fields hardware drives, None if undefined.
            events: hardware's wish to set a `cleared` field.
            answer: the hardware answers the waiting register now, with `answer_data`.
        """
        if i["rst_i"]:
            self.reset()
            return
        out = self.outputs()
        request, accepted = self._dispatch(), self._accepted()
        external = self.external_read
        acked = bool((out["s_axil_bvalid"] and i["s_axil_bready"]) or (out["s_axil_rvalid"] and i["s_axil_rready"]))
        wrote = accepted is not None and accepted[0] == "write"
        was_read = accepted is not None and accepted[0] == "read"

        # Responses
        if self.retimed_done or self.retimed_ack:
            self.is_write[self.put % DEPTH], self.data[self.put % DEPTH] = False, self.retimed
            self.put = (self.put + 1) % (2 * DEPTH)
        elif wrote:
            self.is_write[self.put % DEPTH] = True
            self.put = (self.put + 1) % (2 * DEPTH)
        if acked:
            self.take = (self.take + 1) % (2 * DEPTH)
        self.in_flight += (wrote or was_read) - acked

        # Read path
        mux = accepted[1] if accepted else self.read_address
        reads = was_read and not external
        if answer:
            self.retimed = answer_data
        elif reads:
            self.retimed = self._read(mux, status)
        self.retimed_done, ack_before = reads, self.retimed_ack
        self.retimed_ack = bool(answer)
        self.read_address = mux
        if external and not ack_before:
            self.pending = True
        elif ack_before:
            self.pending = False
        self.stall_write = request is not None and request[0] == "read"

        # Storage
        pulses = dict.fromkeys(self.pulses, 0)
        if wrote:
            assert accepted is not None and self.w is not None
            data, strobes = self.w
            enable = sum(0xFF << 8 * b for b in range(4) if strobes >> b & 1)
            for name in self.by_address.get(accepted[1], []):
                place = self.fields[name]
                mask = (1 << place.width) - 1
                new, bits = data >> place.lsb & mask, enable >> place.lsb & mask
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

        # Requests
        if was_read:
            self.prev_was_rd, self.ar = True, None
        if wrote:
            self.prev_was_rd, self.aw, self.w = False, None, None
        if i["s_axil_arvalid"] and out["s_axil_arready"]:
            self.ar = i["s_axil_araddr"]
        if i["s_axil_awvalid"] and out["s_axil_awready"]:
            self.aw = i["s_axil_awaddr"]
        if i["s_axil_wvalid"] and out["s_axil_wready"]:
            self.w = (i["s_axil_wdata"], i["s_axil_wstrb"])

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
