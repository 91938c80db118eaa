# SPDX-License-Identifier: Apache-2.0
"""Runs commands in forked processes that end at a chosen moment; a program of its own, which reads requests as JSON.

A request is {"arguments": [...], "moment": n or null, "act": what, "limit": bytes or null}. At the n-th function call
of the run, of Python or of C, `act` happens: "kill" is SIGKILL, "remove" removes the folder after `--out`, "term" sends
SIGTERM. A null moment lets the run end, and gives the number of calls at every 10 ms of its time, for choosing moments.
"limit" is the largest size of a file, as on a full disk; "readonly" as `act` obeys file modes even as root.

The answer is {"status": of the process, "calls": [...], "said": its output, "seconds": its duration}.
"""

from __future__ import annotations

import ctypes
import json
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from typing import Any

import cv2

from signum.commands import signals
from signum.commands.cli import application
from signum.report import folder as _report  # noqa: F401  # loaded before the forks, as all others are

EVERY_S = 0.01


def main() -> None:
    """Serve until the input ends."""
    cv2.setNumThreads(1)
    app = application()
    for line in sys.stdin:
        print(json.dumps(_serve(app, json.loads(line))), flush=True)


def _serve(app: Any, request: dict[str, Any]) -> dict[str, Any]:
    with tempfile.TemporaryFile() as calls:
        began = time.monotonic()
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
        with os.fdopen(reading, "rb") as pipe:
            said = pipe.read().decode(errors="replace")
        _, status = os.waitpid(child, 0)
        seconds = time.monotonic() - began
        calls.seek(0)
        return {"status": os.waitstatus_to_exitcode(status), "said": said,
                "calls": json.loads(calls.read() or b"[]"), "seconds": seconds}


def _run(app: Any, request: dict[str, Any], calls: Any) -> int:
    if request.get("limit") is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (request["limit"], request["limit"]))
    if request.get("act") == "readonly":
        _obey_modes()
    signals.listen()
    moment, act, arguments = request.get("moment"), request.get("act"), request["arguments"]
    count, marks, next_mark = 0, [], time.process_time()

    def tick(frame: Any, event: str, argument: Any) -> None:
        nonlocal count, next_mark
        count += 1
        if count == moment:
            if act == "kill":
                os.kill(os.getpid(), signal.SIGKILL)
            elif act == "term":
                os.kill(os.getpid(), signal.SIGTERM)
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


def _obey_modes() -> None:
    """Give up root's right to write where the modes forbid it."""
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)
    none = (ctypes.c_uint32 * 6)()
    ctypes.CDLL(None).capset(header, none)


if __name__ == "__main__":
    main()
