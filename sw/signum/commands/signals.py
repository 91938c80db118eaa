# SPDX-License-Identifier: Apache-2.0
"""How a command is stopped: SIGINT, SIGTERM and SIGHUP alike.

The first signal raises KeyboardInterrupt where the command can stop; what it does then, it has `GRACE_S` for. After
that, or at a second signal, the process ends at once: all files are written so that this loses nothing but the frame at
work.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

SIGNALS = signal.SIGINT, signal.SIGTERM, signal.SIGHUP
GRACE_S = 1.7
"""From the first signal to the end of the process, seconds."""
STATUS = 130
"""Exit status of a command that was stopped."""
GOODBYE = b"\nsignum: stopped; what was finished is kept\n"
SHOW_CURSOR = b"\x1b[?25h"


class _Stop:
    def __init__(self) -> None:
        self.seen = self.asked = False
        self.shielded = 0
        self.told = False
        self.telling = threading.Lock()


_stop = _Stop()


def listen() -> None:
    """Handle the signals from now on, but for those that the process was started to ignore, as under `nohup`.

    Call it in the main thread of a process that runs one command.
    """
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _handle)
    # A thread sees the signals too: the main thread may be in a long call of a library.
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(reader,), daemon=True).start()


@contextmanager
def shielded() -> Iterator[None]:
    """Let what runs inside end before KeyboardInterrupt is raised."""
    _stop.shielded += 1
    try:
        yield
    finally:
        _stop.shielded -= 1
    if _stop.asked and not _stop.shielded:
        _stop.asked = False
        raise KeyboardInterrupt


@contextmanager
def telling() -> Iterator[None]:
    """The user is told inside that the command has stopped; a second signal does not tell it again."""
    with _stop.telling:
        yield
        _stop.told = True


def leave(status: object) -> None:
    """End the process at once if it was stopped and has told so: an interpreter with plots takes most of a second to
    put its libraries away.

    Args:
        status: with which it is about to end.
    """
    if _stop.seen and _stop.told and status == STATUS:
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError):  # whoever read it may have gone
                stream.flush()
        os._exit(STATUS)


def _handle(number: int, frame: FrameType | None) -> None:
    if _stop.seen:  # the thread ends the process
        return
    _stop.seen = True
    if _stop.shielded:
        _stop.asked = True
    else:
        raise KeyboardInterrupt


def _watch(reader: int) -> None:
    while os.read(reader, 1)[0] not in SIGNALS:
        pass
    timer = threading.Timer(GRACE_S, _end)
    timer.daemon = True
    timer.start()
    while os.read(reader, 1)[0] not in SIGNALS:
        pass
    _end()


def _end() -> None:
    """End the process at once."""
    try:
        _stop.telling.acquire(timeout=0.2)
        os.write(2, (SHOW_CURSOR if sys.stderr.isatty() else b"") + (b"" if _stop.told else GOODBYE))
    finally:
        os._exit(STATUS)
