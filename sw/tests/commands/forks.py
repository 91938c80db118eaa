# SPDX-License-Identifier: Apache-2.0
"""Runs commands in forked processes that end at a chosen moment; a program of its own, which reads requests as JSON.

A request is {"arguments": [...], "moment": n or null, "act": what, "limit": bytes or null}. At the n-th function call
of the run, of Python or of C, `act` happens: "kill" is SIGKILL, "remove" removes the folder after `--out`. A null
moment lets the run end, and gives the number of calls at every 10 ms of its time, for choosing moments. "limit" is the
largest size of a file, as on a full disk; "readonly" as `act` obeys file modes even as root. "signals" are sent one
after the other when the file "grown" has "lines" lines, while frames come one every 50 ms. "film" is what camera 0
shows from frame "first" on, a frame every 20 ms more.

The answer is {"status": of the process, "calls": [...], "said": its output, "stopped_s": from the first of the signals
to the end of the process}.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import json
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import typer

from signum.commands import signals
from signum.commands.cli import application
from signum.frames.frame import Frame, Source
from signum.report import folder as _report  # noqa: F401  # loaded before the forks, as all others are

EVERY_S = 0.01
PACE_S = 0.05
"""Between frames of a run that is signalled: however fast the machine, frames are still to come then."""


def main() -> None:
    """Serve until the input ends."""
    for number in signals.SIGNALS:  # ignored where the tests run in the background or under nohup, and so by commands
        signal.signal(number, signal.SIG_DFL)
    cv2.setNumThreads(1)
    app = typer.main.get_command(application())
    with contextlib.suppress(SystemExit), open(os.devnull, "w") as sink, contextlib.redirect_stderr(sink):
        app(["filter", "", "--out", ""])  # loads what parsing needs
    gc.freeze()  # else a collection in a child copies all that is shared with it
    for line in sys.stdin:
        print(json.dumps(_serve(app, json.loads(line))), flush=True)


def _serve(app: Any, request: dict[str, Any]) -> dict[str, Any]:
    with tempfile.TemporaryFile() as calls:
        reading, writing = os.pipe()  # not a file, whose size would be limited too
        child = os.fork()
        if not child:
            os.dup2(writing, 1)
            os.dup2(writing, 2)
            os.close(writing)
            os.close(reading)
            os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
            status = 70
            try:
                status = _run(app, request, calls)
            except BaseException:
                traceback.print_exc()
            finally:
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(status)
        os.close(writing)
        began = _signal(child, request) if "signals" in request else 0.0
        with os.fdopen(reading, "rb") as pipe:
            said = pipe.read().decode(errors="replace")
        _, status = os.waitpid(child, 0)
        stopped = time.monotonic() - began
        calls.seek(0)
        return {"status": os.waitstatus_to_exitcode(status), "said": said,
                "calls": json.loads(calls.read() or b"[]"), "stopped_s": stopped}


def _signal(child: int, request: dict[str, Any]) -> float:
    """Send signals to a child when its file has grown; returns when the first was sent."""
    grown = Path(request["grown"])
    while not grown.exists() or grown.read_bytes().count(b"\n") < request["lines"]:
        if os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT):
            break
        time.sleep(0.002)
    began = time.monotonic()
    for number in request["signals"]:
        os.kill(child, number)
        time.sleep(0.02)
    return began


class _Camera:
    """A camera that shows a film."""

    film, first = "", 0
    player = cv2.VideoCapture

    def __init__(self, index: int) -> None:
        self._film = _Camera.player(_Camera.film)
        for _ in range(_Camera.first):
            self._film.read()

    def isOpened(self) -> bool:
        return self._film.isOpened()

    def read(self) -> Any:
        time.sleep(0.02)
        return self._film.read()

    def release(self) -> None:
        self._film.release()


def _run(app: Any, request: dict[str, Any], calls: Any) -> int:
    if request.get("limit") is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (request["limit"], request["limit"]))
    if "film" in request:
        _Camera.film, _Camera.first = request["film"], request["first"]
        cv2.VideoCapture = _Camera  # type: ignore[misc,assignment]
    if request.get("act") == "readonly":
        _obey_modes()
    if "signals" in request:
        _pace()
    signals.listen()
    moment, act, arguments = request.get("moment"), request.get("act"), request["arguments"]
    count, marks, next_mark = 0, [], time.process_time()

    def tick(frame: Any, event: str, argument: Any) -> None:
        nonlocal count, next_mark
        count += 1
        if count == moment:
            if act == "kill":
                os.kill(os.getpid(), signal.SIGKILL)
            elif act == "remove":
                shutil.rmtree(arguments[arguments.index("--out") + 1], ignore_errors=True)
        if moment is None and time.process_time() >= next_mark:
            marks.append(count)
            next_mark += EVERY_S

    if moment is not None or (act is None and request.get("limit") is None):
        sys.setprofile(tick)
    try:
        app(arguments, standalone_mode=True)
        status = 0
    except SystemExit as end:
        status = int(end.code or 0)
    finally:
        sys.setprofile(None)
    if moment is None and request.get("limit") is None:
        calls.write(json.dumps(marks).encode())
        calls.flush()
    return status


def _pace() -> None:
    """Let every source wait between its frames."""
    frames = Source.__iter__

    def paced(self: Source) -> Iterator[Frame]:
        for frame in frames(self):
            yield frame
            time.sleep(PACE_S)

    Source.__iter__ = paced  # type: ignore[method-assign]


def _obey_modes() -> None:
    """Give up root's right to write where the modes forbid it."""
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)
    none = (ctypes.c_uint32 * 6)()
    ctypes.CDLL(None).capset(header, none)


if __name__ == "__main__":
    main()
