# SPDX-License-Identifier: Apache-2.0
"""The `signum` command: all its subcommands, each of which adds itself to the application."""

from __future__ import annotations

import importlib
import sys

import typer

from signum.commands.app import app
from signum.commands.signals import leave, listen

COMMANDS = ("calibrate", "demo", "export", "filter", "flow", "follow", "hold", "info", "mosaic", "navigate", "report",
            "simulate", "stereo", "track")
"""Names of the commands and of their modules in `signum.commands`."""


def application(*commands: str) -> typer.Typer:
    """The application with these commands, by default all; loading few is faster, as each imports its libraries."""
    for name in commands or COMMANDS:
        importlib.import_module(f"signum.commands.{name}")
    return app


def main() -> None:
    """Run the command line."""
    listen()
    asked = [name for name in sys.argv[1:2] if name in COMMANDS]
    try:
        application(*asked)()
    except BrokenPipeError:
        sys.exit(0)
    except KeyboardInterrupt:  # while still loading
        sys.exit(130)
    except SystemExit as end:
        leave(end.code)
        raise


if __name__ == "__main__":
    main()
