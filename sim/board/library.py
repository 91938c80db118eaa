# SPDX-License-Identifier: Apache-2.0
"""The C interfaces of the shared libraries of this folder, for ctypes."""

from __future__ import annotations

import ctypes
from pathlib import Path

READ = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_uint32, ctypes.POINTER(ctypes.c_uint32))
WRITE = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_uint32, ctypes.c_uint32)

TIMEOUT = -1
STREAM_BROKEN = -2
"""Return values of functions that failed; 0 is success."""

_P, _I, _U, _N, _T = ctypes.c_void_p, ctypes.c_int, ctypes.c_uint32, ctypes.c_int64, ctypes.c_uint64
Signatures = dict[str, tuple[object, list[object]]]
"""Result and arguments by function, without the prefix `slog_`."""

DRIVER: Signatures = {
    "read": (_U, [_P, _U]), "write": (None, [_P, _U, _U]), "failed": (_I, [_P]), "start": (None, [_P]),
    "set_filter": (_I, [_P, _P, _P, _I, _I, _I, _T]), "wait_filter": (_I, [_P, _T]),
    "abort_frames": (_U, [_P]), "arm": (_I, [_P, _I, _I]), "disarm": (None, [_P, _I]),
    "wait_captured": (_I, [_P, _U, _T]), "submit": (None, [_P, _P, _N]), "collect": (_I, [_P, _P, _N, _T]),
    "outstanding": (_N, [_P]), "peek": (None, [_P, _U, _P, _N]), "counters": (_N, [_P, _P]),
}
"""Functions of `driver_api.cpp`, which is part of both libraries: the first argument is what `driver` returns."""
BOARD: Signatures = {
    "new": (_P, [_U]), "free": (None, [_P]), "driver": (_P, [_P]), "clocks": (_T, [_P]), "irq": (_I, [_P]),
    "trace": (_I, [_P, ctypes.c_char_p]), "tick": (None, [_P, _T]), "reset": (None, [_P]), "restart": (None, [_P, _I]),
    "play": (None, [_P, _I, _P, _T, _U, _T]), "play_frame": (None, [_P, _I, _P, _I, _I, _U, _T]),
    "finish_playing": (_I, [_P, _T]), "pause_stream": (None, [_P, _U, _T]), "stream_waiting": (_N, [_P]),
    "asserted": (_I, [_P]), "accesses": (_N, [_P, _P, _N, _I]),
}
"""Functions of `api.cpp`: the first argument is what `new` returns."""
SURFACE: Signatures = {"surface": (_I, [_P, _P, _N, _T])}
"""A further one of boards with the array."""
MAP: Signatures = {"map": (_N, [_P, _P, _N, _T])}
"""A further one of boards with a dense engine."""
CALLBACKS: Signatures = {"callbacks_new": (_P, [READ, WRITE]), "callbacks_free": (None, [_P]), "driver": (_P, [_P])}
"""Functions of `callbacks.cpp`: the first argument is what `callbacks_new` returns."""


def load(path: Path, own: Signatures) -> ctypes.CDLL:
    """The library at `path`, with the functions of the driver and its own."""
    library = ctypes.CDLL(str(path))
    for name, (result, arguments) in {**DRIVER, **own}.items():
        function = getattr(library, f"slog_{name}")
        function.restype, function.argtypes = result, arguments
    return library
