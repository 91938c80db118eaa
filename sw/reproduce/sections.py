"""What the page of `make reproduce` is made of, in its order."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec

from sw.reproduce import Maker

NAMES = ("filter", "flow", "tracking", "stereo", "hold", "follow", "mosaics", "survey", "navigate")


def makers() -> dict[str, Maker]:
    """Makers by name."""
    return {name: import_module(f"sw.reproduce.{name}").make for name in NAMES if find_spec(f"sw.reproduce.{name}")}
