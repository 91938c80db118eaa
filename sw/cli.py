"""The `signum` command: all its subcommands, each of which adds itself to the application."""

from __future__ import annotations

import sys

from sw.commands import demo, filter, flow, follow, hold, info, mosaic, navigate, report, simulate, stereo, track
from sw.commands.common import app

__all__ = ["app", "demo", "filter", "flow", "follow", "hold", "info", "main", "mosaic", "navigate", "report",
           "simulate", "stereo", "track"]


def main() -> None:
    """Entry point."""
    try:
        app()
    except BrokenPipeError:
        sys.exit(0)


if __name__ == "__main__":
    main()
