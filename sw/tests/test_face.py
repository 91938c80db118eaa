# SPDX-License-Identifier: Apache-2.0
"""The stable face: what `signum` exports, with signatures, is what `face.txt` keeps.

Where a change is meant, `SIGNUM_FACE=write` makes this test write the file anew; the change belongs into CHANGELOG.md.
"""

import inspect
import os
from collections.abc import Iterator
from enum import Enum
from pathlib import Path

import signum

KEPT = Path(__file__).with_name("face.txt")


def _signature(function: object) -> str:
    """Parameters as the source annotates them, whatever Python prints of them."""
    signature = inspect.signature(function)  # type: ignore[arg-type]
    return str(signature).replace("'", "")


def _members(kind: type) -> Iterator[str]:
    """Public members of a class and of those it derives from, beneath the class's own line."""
    for name in sorted(name for name in dir(kind) if not name.startswith("_")):
        member = inspect.getattr_static(kind, name)
        home = next(base for base in kind.__mro__ if name in vars(base))
        if home.__module__.partition(".")[0] not in ("signum", "golden", "sim"):
            continue
        if isinstance(member, property):
            yield f"    {name}: {inspect.get_annotations(member.fget)['return']}"  # type: ignore[arg-type]
        elif isinstance(member, (staticmethod, classmethod)) or inspect.isfunction(member):
            yield f"    {name}{_signature(getattr(kind, name))}"
        elif issubclass(kind, Enum):
            yield f"    {name} = {kind[name].value!r}"


def _face() -> Iterator[str]:
    for name in sorted(signum.__all__):
        thing = getattr(signum, name)
        if inspect.isclass(thing):
            yield f"class {name}{'' if issubclass(thing, (Exception, str, int)) else _signature(thing)}"
            yield from _members(thing)
        elif callable(thing):
            yield f"def {name}{_signature(thing)}"
        else:
            yield f"{name}: {type(thing).__name__}"


def test_the_face_is_the_one_that_is_kept() -> None:
    face = "\n".join(_face()) + "\n"
    if os.environ.get("SIGNUM_FACE") == "write":
        KEPT.write_text(face)
    assert KEPT.read_text() == face, "the face has changed: see this file's docstring"


def test_every_name_is_documented() -> None:
    bare = [name for name in signum.__all__ if callable(getattr(signum, name)) and not getattr(signum, name).__doc__]
    missing = [name for name in ("Job", "Result", "Peak", "Measurement", "Survey", "StationMeter", "Localiser")
               if f"`{name}`" not in (signum.__doc__ or "")]
    assert not bare and not missing
