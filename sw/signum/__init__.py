"""Signum's host side: the names a host script needs.

Each is loaded on first use, so that `import signum` is quick and rooms below may import `signum.common`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

__all__ = [
    "FULL", "TINY", "Board", "BoardError", "Config", "Fit", "FlowField", "Frame", "Identification", "Job",
    "Measurement", "Measurer", "Query", "RangeMap", "Reason", "Registrar", "Registration", "RegistrationLimits",
    "Result", "Rules", "SignumError", "Similarity", "Source", "SourceError", "Status", "TrackPoint", "TrackSettings",
    "Tracker", "View", "measure_flow", "measure_range", "open_board", "open_source", "read_picture", "run_jobs",
]

_MODULES = {
    "golden.correlate": ("Job", "Result", "Status"),
    "golden.params": ("FULL", "TINY", "Config"),
    "signum.boards": ("open_board",),
    "signum.boards.board": ("Board", "BoardError", "Identification", "run_jobs"),
    "signum.common.errors": ("SignumError", "SourceError"),
    "signum.frames.fit": ("Fit",),
    "signum.frames.frame": ("Frame", "Source", "read_picture"),
    "signum.geometry.similarity": ("Similarity",),
    "signum.measure.flow": ("FlowField", "measure_flow"),
    "signum.measure.measurer": ("Measurement", "Measurer", "Query", "View"),
    "signum.measure.register": ("Registrar", "Registration", "RegistrationLimits"),
    "signum.measure.stereo": ("RangeMap", "measure_range"),
    "signum.measure.track": ("TrackPoint", "TrackSettings", "Tracker"),
    "signum.measure.validity": ("Reason", "Rules"),
    "signum.sources.open": ("open_source",),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}

if TYPE_CHECKING:
    from golden.correlate import Job, Result, Status
    from golden.params import FULL, TINY, Config
    from signum.boards import open_board
    from signum.boards.board import Board, BoardError, Identification, run_jobs
    from signum.common.errors import SignumError, SourceError
    from signum.frames.fit import Fit
    from signum.frames.frame import Frame, Source, read_picture
    from signum.geometry.similarity import Similarity
    from signum.measure.flow import FlowField, measure_flow
    from signum.measure.measurer import Measurement, Measurer, Query, View
    from signum.measure.register import Registrar, Registration, RegistrationLimits
    from signum.measure.stereo import RangeMap, measure_range
    from signum.measure.track import Tracker, TrackPoint, TrackSettings
    from signum.measure.validity import Reason, Rules
    from signum.sources.open import open_source
else:
    def __getattr__(name: str) -> object:
        if name not in _HOME:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = globals()[name] = getattr(import_module(_HOME[name]), name)
        return value

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})
