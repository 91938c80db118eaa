# SPDX-License-Identifier: Apache-2.0
"""What everything that sends measurements has: a link, the clock of its stamps, and what became of the messages."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from signum.applications.mavlink.link import Link
from signum.applications.mavlink.stamp import Stamp


class LinkSink:
    """Sends over a link of its own; close it, or use it in a `with`.

    Args:
        address: see `open_channel`.

    Attributes:
        link: to the autopilot; its `vehicle` has what arrived.
        stamp: of the messages.

    Raises:
        SignumError: if pymavlink is not installed, or the address cannot be opened or resolved or is refused.
    """

    def __init__(self, address: str) -> None:
        self.link = Link(address)
        self.stamp = Stamp(self.link.vehicle.clock)

    @property
    def sent(self) -> int:
        """Messages that the link took; HEARTBEAT and TIMESYNC are not among them."""
        return self.link.sent

    @property
    def failed(self) -> int:
        """Messages that the link did not take."""
        return self.link.failed

    @property
    def said(self) -> str:
        """How many messages were sent, and what was not, for the line on an outcome."""
        return f"{self.sent} MAVLink messages" + (f", {self.failed} could not be sent" if self.failed else "")

    def close(self) -> None:
        """Close the link."""
        self.link.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()
