"""The errors a user can correct."""

from __future__ import annotations


class SignumError(Exception):
    """An input that cannot be used; the message is one line and names the remedy."""


class SourceError(SignumError):
    """A source of frames, or a frame, that cannot be used."""
