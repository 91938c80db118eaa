"""The `signum` application, and what makes a function one of its commands: option groups, errors in one line."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from typing import Annotated, Any, get_type_hints

import typer

from signum.boards.board import BoardError
from signum.common.console import notes, out
from signum.common.errors import SignumError
from signum.common.version import VERSION

LONGEST = 500
"""Characters of an error line; the rest, such as a tool's whole output, is cut off."""

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
    Errors the user can mend are one line and status 1; an interrupt is status 130.
    """
    def add(function: Callable[..., None]) -> Callable[..., None]:
        app.command(name)(_guarded(_ungrouped(function)))
        return function
    return add


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
        except (FileExistsError, NotADirectoryError) as error:
            _fail(f"{error.filename} is a file: choose another folder with --out")
        except OSError as error:
            _fail(f"{error.filename or 'file'}: {error.strerror or error}; mend that, or choose another --out")
        except KeyboardInterrupt:
            notes.print("signum: stopped; what was finished is kept")
            raise typer.Exit(130) from None
    return run


def _fail(message: str) -> None:
    line = " ".join(message.split())
    notes.print(f"signum: {line if len(line) <= LONGEST else line[:LONGEST] + ' ...'}", markup=False)
    raise typer.Exit(1)
