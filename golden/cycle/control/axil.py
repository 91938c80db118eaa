# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_axil`: accesses over AXI4-Lite, one at a time, passed to the register block."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Request:
    """An access: its byte address, and the data and byte strobes of a write."""

    address: int
    is_write: bool
    data: int = 0
    strobes: int = 0

    @property
    def enable(self) -> int:
        """The bits that a write changes."""
        return sum(0xFF << 8 * byte for byte in range(4) if self.strobes >> byte & 1)


class AxilModel:
    """AXI4-Lite to requests.

    Args:
        waits: address whose reads wait until the hardware is ready.
    """

    INPUTS = ("s_axil_awaddr", "s_axil_awprot", "s_axil_awvalid", "s_axil_wdata", "s_axil_wstrb", "s_axil_wvalid",
              "s_axil_bready", "s_axil_araddr", "s_axil_arprot", "s_axil_arvalid", "s_axil_rready")
    OUTPUTS = ("s_axil_awready", "s_axil_wready", "s_axil_bresp", "s_axil_bvalid", "s_axil_arready", "s_axil_rdata",
               "s_axil_rresp", "s_axil_rvalid")

    def __init__(self, waits: int) -> None:
        self.waits = waits
        self.rdata: int | None = None
        self._reset()

    def _reset(self) -> None:
        self.fresh = True  # nothing is accepted yet
        self.ar: int | None = None
        self.aw: int | None = None
        self.w: tuple[int, int] | None = None
        self.ar_settled = self.aw_settled = self.w_settled = False  # held since the clock before
        self.under_way, self.read_last = False, False
        self.begun: Request | None = None  # the access that begins in this clock
        self.asked: Request | None = None  # the access that began in the clock before
        self.request: Request | None = None  # the access that began two clocks before: it is passed on in this clock
        self.bvalid, self.rvalid = False, False

    def _chosen(self, wait: bool) -> Request | None:
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

    def outputs(self) -> dict[str, int | None]:
        """Outputs of this clock; all are registers."""
        return {
            "s_axil_arready": int(self.ar is None and not self.fresh),
            "s_axil_awready": int(self.aw is None and not self.fresh),
            "s_axil_wready": int(self.w is None and not self.fresh), "s_axil_bvalid": int(self.bvalid),
            "s_axil_rvalid": int(self.rvalid), "s_axil_rdata": self.rdata, "s_axil_bresp": 0, "s_axil_rresp": 0,
        }

    def edge(self, i: Mapping[str, int], wait: bool, wrote: bool, answer: tuple[int | None] | None) -> None:
        """Take the clock edge.

        Args:
            i: inputs.
            wait: the waiting register is not ready.
            wrote: the register block carries out a write in this clock.
            answer: the value that the register block returns to a read in this clock.
        """
        if answer is not None:
            self.rdata = answer[0]
        if i["rst_i"]:
            self._reset()
            return
        chosen, begun = self._chosen(wait), self.begun
        ended = (self.bvalid and i["s_axil_bready"]) or (self.rvalid and i["s_axil_rready"])
        self.rvalid = answer is not None or (self.rvalid and not i["s_axil_rready"])
        self.bvalid = wrote or (self.bvalid and not i["s_axil_bready"])
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
