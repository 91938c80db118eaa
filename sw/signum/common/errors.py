"""The errors a user can mend: one clear line each, with the remedy."""

from __future__ import annotations


class SignumError(Exception):
    """Something the user handed over cannot be used; the message is one line and names the remedy."""


class SourceError(SignumError):
    """A picture, folder, video or camera that cannot be used."""
