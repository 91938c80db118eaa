# SPDX-License-Identifier: Apache-2.0
"""Addresses of streams, and how they are shown: without passwords, as reports are passed on."""

from __future__ import annotations

import re

STREAM = re.compile(r"(rtsps?|udp|rtp|https?)://", re.IGNORECASE)
"""Begins the address of a stream."""
HIDDEN = "***"
_USER = re.compile(r"^(\w+://)[^/?#@]*@")
_SECRET = re.compile(r"([?&][^=&]*(?:pass|pwd|token|secret|key|auth)[^=&]*=)[^&#]*", re.IGNORECASE)


def is_stream(text: str) -> bool:
    """Whether a text is the address of a stream."""
    return STREAM.match(text) is not None


def without_secrets(text: str) -> str:
    """The address of a stream with user, password and the like hidden; any other text as it is."""
    if not is_stream(text):
        return text
    return _SECRET.sub(rf"\g<1>{HIDDEN}", _USER.sub(rf"\g<1>{HIDDEN}@", text))
