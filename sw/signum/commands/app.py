# SPDX-License-Identifier: Apache-2.0
"""The `signum` application, and what makes a function one of its commands: option groups, errors in one line."""

from __future__ import annotations

import errno
import functools
import inspect
import os
import shlex
import tempfile
import traceback
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from itertools import chain
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from signum.boards.board import BoardError
from signum.commands import signals
from signum.commands.options import GIVEN, MegapixelsOption
from signum.commands.outputs import check_inputs
from signum.common.checks import MEGAPIXELS, megapixels, option
from signum.common.console import notes, out
from signum.common.errors import SignumError
from signum.common.files import real_path
from signum.common.urls import without_secrets
from signum.common.version import VERSION

LONGEST = 500
"""Characters of an error line; the rest, such as a tool's whole output, is cut off."""
LOG = "signum-error.log"
"""File in the output folder that an unexpected error leaves."""
RAISE = "SIGNUM_RAISE"
"""Environment variable with which an unexpected error is raised, so that tests and `make fuzz` see it."""
OUTPUT = "output"
"""The parameter that holds a command's output folder."""
REPORTED = "folder"
"""That of `signum report`."""

app = typer.Typer(
    name="signum", no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    help="Sign-of-LoG vision for underwater robots: filters, tracks and builds mosaics on a simulated board.")


def _print_version(asked: bool) -> None:
    if asked:
        out.print(f"signum {VERSION}", highlight=False)
        raise typer.Exit


@app.callback()
def _signum(version: Annotated[bool, typer.Option(
        "--version", is_eager=True, callback=_print_version, help="Print the version and end.")] = False) -> None:
    """Only with a callback does Typer require a command's name where a single command is loaded."""


def command(name: str | None = None) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Add a function to the application as a command.

    A parameter whose type is a dataclass is a group of options: each of its fields is an option of the command line,
    and the function gets them as one object. A group's default is an object, whose values are the options' defaults.
    Every command has `--megapixels`. Errors the user can mend are one line and status 1; an interrupt is status 130;
    anything else is one line, status 1 and a log file.
    """
    def add(function: Callable[..., None]) -> Callable[..., None]:
        app.command(name)(_guarded(_checked(_ungrouped(function))))
        return function
    return add


def _checked(function: Callable[..., None]) -> Callable[..., None]:
    """The function with every value of the command line checked, and the limit of a picture's size as an option."""
    signature = inspect.signature(function)
    limit = inspect.Parameter("largest", inspect.Parameter.KEYWORD_ONLY, default=MEGAPIXELS,
                              annotation=MegapixelsOption)

    @functools.wraps(function)
    def run(largest: float = MEGAPIXELS, **values: object) -> None:
        for name, value in values.items():
            option(value, _shown(signature.parameters[name]))
        if OUTPUT in values and not str(values[OUTPUT]).isprintable():
            raise SignumError(f"--out {values[OUTPUT]}: expected a folder's name in UTF-8 without control characters")
        if isinstance(output := values.get(OUTPUT), Path):
            check_inputs(output, function.__name__.rstrip("_"), {k: v for k, v in values.items() if k != OUTPUT})
        token = GIVEN.set(" ".join(chain.from_iterable(_words(signature.parameters[n], v) for n, v in values.items())))
        try:
            with megapixels(largest):
                function(**values)
        finally:
            GIVEN.reset(token)

    run.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=[*signature.parameters.values(), limit])
    run.__annotations__ = function.__annotations__ | {"largest": MegapixelsOption}
    return run


def _shown(parameter: inspect.Parameter) -> str:
    """A parameter as the command line names it."""
    return _names(parameter).partition("/")[0] or parameter.name.upper()


def _words(parameter: inspect.Parameter, value: object) -> list[str]:
    """An option with its value as words of the command line; none for an argument, or without a value."""
    name, _, negative = _names(parameter).partition("/")
    if not name or value is None:
        return []
    if isinstance(value, bool):
        return [name] if value else [negative] if negative else []
    return [name, shlex.quote(without_secrets(str(value)))]


def _names(parameter: inspect.Parameter) -> str:
    """An option's name, for a switch with that of its opposite, `--live/--no-live`; empty for an argument."""
    for about in getattr(parameter.annotation, "__metadata__", ()):
        # Typer takes an option's first name for its default until it reads the annotation.
        for name in (getattr(about, "default", None), *(getattr(about, "param_decls", None) or ())):
            if str(name).startswith("--"):
                return str(name)
    return ""


def _ungrouped(function: Callable[..., None]) -> Callable[..., None]:
    """The function with the fields of its option groups as parameters of their own."""
    hints = get_type_hints(function, include_extras=True)
    groups: dict[str, Any] = {}
    shown: list[inspect.Parameter] = []
    for parameter in inspect.signature(function).parameters.values():
        kind = hints[parameter.name]
        if is_dataclass(kind):
            groups[parameter.name] = kind
            given = None if parameter.default is inspect.Parameter.empty else parameter.default
            types = get_type_hints(kind, include_extras=True)
            shown += [parameter.replace(name=field.name, annotation=types[field.name],
                                        default=getattr(given or kind, field.name)) for field in fields(kind)]
        else:
            shown.append(parameter.replace(annotation=kind))

    @functools.wraps(function)
    def run(**values: object) -> None:
        for parameter, kind in groups.items():
            values[parameter] = _taken(kind, values)
        function(**values)

    run.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in shown])
    run.__annotations__ = {p.name: p.annotation for p in shown} | {"return": None}
    return run


def _taken(kind: Callable[..., object], values: dict[str, object]) -> object:
    """A group's object, of values that are taken out of all of them."""
    names: Mapping[str, inspect.Parameter] = inspect.signature(kind).parameters
    taken = {name: values.pop(name) for name in names}
    return kind(**taken)


def _guarded(function: Callable[..., None]) -> Callable[..., None]:
    """The function with its errors in one line and a status."""
    @functools.wraps(function)
    def run(**values: object) -> None:
        try:
            function(**values)
        except (SignumError, BoardError) as error:
            _fail(str(error))
        except BrokenPipeError:
            raise
        except (FileExistsError, NotADirectoryError) as error:
            kind = "a link that leads nowhere" if os.path.islink(error.filename) else "a file"
            _fail(f"{error.filename} is {kind}: choose another folder with --out")
        except OSError as error:
            name = error.filename if error.filename is not None else _written_by(error) or values.get(OUTPUT, "file")
            shown = os.fsdecode(name) if isinstance(name, bytes) else str(name)
            _fail(f"{shown}: {_reason(error)}; mend that{', or choose another --out' * _within(shown, values)}")
        except KeyboardInterrupt:
            with signals.telling():
                notes.print("signum: stopped; what was finished is kept")
            raise typer.Exit(130) from None
        except typer.Exit:
            raise
        except Exception as error:
            if os.environ.get(RAISE):
                raise
            _fail(_unexpected(error, function.__name__, values))
    return run


def _within(name: str, values: Mapping[str, object]) -> bool:
    """Whether a file lies in the command's output folder, or is it."""
    output = values.get(OUTPUT)
    return isinstance(output, Path) and real_path(name).is_relative_to(real_path(output))


def _reason(error: OSError) -> str:
    """What the system says of an error; which of the user's limits it is, where that is known."""
    known = {errno.ENOSPC: "the disk is full", errno.EDQUOT: "the disk quota is used up",
             errno.EFBIG: "the file is larger than this process may write"}
    return known.get(error.errno or 0, error.strerror or str(error))


def _written_by(error: OSError) -> str | None:
    """The name of the file that a failing write is for, which the error does not carry: from the object that wrote."""
    name = None
    for frame, _ in traceback.walk_tb(error.__traceback__):
        for holder in ("path", "file", "self"):
            value = frame.f_locals.get(holder)
            value = getattr(value, "path", None) if holder == "self" else value
            name = str(value) if isinstance(value, Path) else name
    return name


def _unexpected(error: Exception, command: str, values: Mapping[str, object]) -> str:
    """Write the log of an unexpected error beside the output; returns the line for the user."""
    given = "".join(f"  {name}: {without_secrets(str(value))}\n" for name, value in sorted(values.items()))
    text = f"signum {command}\n{given}\n{''.join(traceback.format_exception(error))}"
    line = f"unexpected {type(error).__name__} in `signum {command}` ({error})"
    output = values.get(OUTPUT, values.get(REPORTED))
    for folder in (output if isinstance(output, Path) else Path(), Path(tempfile.gettempdir())):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            (folder / LOG).write_text(text, encoding="utf-8", errors="backslashreplace")
        except (OSError, ValueError):
            continue
        return f"{folder / LOG}: {line}: please report it with this file"
    return f"{line}; no log could be written"


def _fail(message: str) -> None:
    line = " ".join(message.split())
    notes.print(f"signum: {line if len(line) <= LONGEST else line[:LONGEST] + ' ...'}")
    raise typer.Exit(1)
