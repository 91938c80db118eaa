# SPDX-License-Identifier: Apache-2.0
"""The errors a user can correct."""

from __future__ import annotations


class SignumError(Exception):
    """An input that cannot be used; the message is one line and names the remedy."""


class SourceError(SignumError):
    """A source of frames, or a frame, that cannot be used."""


def lacking(extra: str, error: ModuleNotFoundError) -> SignumError:
    """The error for a library that only an extra of the package installs.

    Args:
        extra: its name in `pyproject.toml`.
        error: of the import.
    """
    return SignumError(f"{error.name} is not installed: it comes with the extra `{extra}`: "
                       f"pip install 'signum[{extra}]' (in a clone: make setup)")
