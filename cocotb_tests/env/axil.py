# SPDX-License-Identifier: Apache-2.0
"""AXI4-Lite master as part of a stimulus: plays accesses on the five channels, one after another or overlapped."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from golden.cycle.model import Inputs, Outputs


@dataclass
class Access:
    """One register access; a read's data is filled in when it has come: None if undefined."""

    address: int
    write: bool = False
    data: int | None = 0
    strobes: int = 0xF
    done: bool = False


class AxilMaster:
    """Call `drive` for a clock's inputs, `observe` with its outputs.

    Args:
        ready: whether the response channels are ready, clock by clock.
        overlap: accesses under way at once; 1 keeps the order of reads and writes among each other.
    """

    def __init__(self, ready: Iterator[int], overlap: int = 1) -> None:
        self.ready, self.overlap = ready, overlap
        self.finished = 0
        self.reset()

    def reset(self) -> None:
        """Forget everything queued and under way, as the board does in reset."""
        self.waiting: deque[Access] = deque()
        self.requests: dict[str, deque[Access]] = {"aw": deque(), "w": deque(), "ar": deque()}
        self.responses: dict[str, deque[Access]] = {"b": deque(), "r": deque()}
        self._inputs: Inputs = {}

    def read(self, address: int) -> Access:
        """Queue a read."""
        self.waiting.append(Access(address))
        return self.waiting[-1]

    def write(self, address: int, data: int, strobes: int = 0xF) -> Access:
        """Queue a write."""
        self.waiting.append(Access(address, True, data, strobes))
        return self.waiting[-1]

    @property
    def idle(self) -> bool:
        """Everything queued has been answered."""
        return not self.waiting and not any(self.responses.values())

    def drive(self) -> Inputs:
        """Inputs of this clock."""
        while self.waiting and sum(map(len, self.responses.values())) < self.overlap:
            access = self.waiting.popleft()
            for channel in ("aw", "w") if access.write else ("ar",):
                self.requests[channel].append(access)
            self.responses["b" if access.write else "r"].append(access)
        aw, w, ar = (q[0] if q else None for q in self.requests.values())
        ready = next(self.ready)
        self._inputs = {
            "s_axil_awvalid": int(aw is not None), "s_axil_awaddr": aw.address if aw else 0,
            "s_axil_wvalid": int(w is not None), "s_axil_wdata": (w.data or 0) if w else 0,
            "s_axil_wstrb": w.strobes if w else 0,
            "s_axil_arvalid": int(ar is not None), "s_axil_araddr": ar.address if ar else 0,
            "s_axil_bready": ready, "s_axil_rready": ready}
        return self._inputs

    def observe(self, out: Outputs) -> None:
        """Take what was handed over in this clock."""
        for channel, queue in self.requests.items():
            if self._inputs[f"s_axil_{channel}valid"] and out[f"s_axil_{channel}ready"]:
                queue.popleft()
        for channel, queue in self.responses.items():
            if out[f"s_axil_{channel}valid"] and self._inputs[f"s_axil_{channel}ready"]:
                access = queue.popleft()
                if channel == "r":
                    access.data = out["s_axil_rdata"]
                access.done = True
                self.finished += 1
