# SPDX-License-Identifier: Apache-2.0
"""Signum's host side: the names a host script needs, and the only ones whose meaning is kept from version to version.

    from signum import Job, Measurer, Query, grid, locate_peaks, open_board, run_jobs

- Boards: `open_board` gives a `Board`, built as `FULL`, `TINY` or `DENSE` (`Config`): frames in (`capture`), sign
  planes out (`read_plane`), jobs (`submit`, `run_jobs`), grids of jobs (`submit_grid`, whose jobs `grid` lists),
  results (`collect`) and whole surfaces (`surface`). A `DENSE` board has no array: `dense` runs a `DenseJob`, which
  searches a `DensePass` around every pixel, and gives a `DenseResult`. `BoardError` is raised for what a board cannot
  do.
- Results: a `Job` has a `Result`: the bits of the board. Its `patch` is the 3x3 scores round the best, rows from the
  top, columns from the left. `locate_peaks` turns results into `Peak`s: sub-pixel offsets, and `above_chance`, how many
  standard deviations of a chance score the peak lies above a chance match. A search always has a best place; one that
  saw nothing but chance reaches 2 to 4, so do not use one below about 6.
- Measurements: `Measurer` takes `View`s and answers each `Query` with a `Measurement`, validated by `Rules`, whose
  `valid` and `reason` must be looked at.
- Tasks: `measure_flow`, `measure_range` (stereo), both at every pixel on a `DENSE` board (`measure_dense_flow`,
  `measure_dense_range`) and there what moves by itself (`segment_moving`), `Tracker`, `Registrar`, `Survey` (mosaics),
  `StationMeter` (hover) and `MavlinkSink`, `Follower` (with `RangeEye`, `MotionEye` or `DenseEye`), `Localiser` in a
  `Chart`.
- Frames: `open_source` gives a `Source` of `Frame`s; `Fit` scales them for the board; `open_lens` and `open_rig`
  open calibrations. `SignumError` and those derived from it have one line that names the remedy.

Names are loaded on first use, so that `import signum` is quick and rooms below may import `signum.common`. What lies in
the modules beneath, and is not named here, may change without notice.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from signum.common.version import VERSION

__version__ = VERSION

__all__ = [
    "DENSE", "FULL", "NO_SCORE", "TINY", "Background", "Board", "BoardError", "Chart", "Config", "DenseEye",
    "DenseFlowRules", "DenseJob", "DensePass", "DenseResult", "DenseStereoRules", "Fit", "FlowField", "Follower",
    "Frame", "Identification", "Job", "Lens", "Level", "LocaliseLimits", "Localiser", "MavlinkSink",
    "Measurement", "Measurer", "MotionEye", "Moving", "MovingObject", "MovingRules", "Peak", "Place", "Query",
    "RangeEye", "RangeMap", "Reading", "Reason", "Rectifier", "Registrar", "Registration", "RegistrationLimits",
    "Result", "Rig", "Rules", "SignumError", "Similarity", "Source", "SourceError", "StationMeter", "Status",
    "StereoGeometry", "Survey", "SurveySettings", "Target", "TrackPoint", "TrackSettings", "Tracker", "View",
    "grid", "locate_peaks", "measure_dense_flow", "measure_dense_range", "measure_flow", "measure_range",
    "open_board", "open_lens", "open_rig", "open_source", "read_mono", "read_picture", "read_stereo", "run_jobs",
    "segment_moving",
]

_MODULES = {
    "golden.correlate": ("Job", "Result", "Status", "grid"),
    "golden.dense": ("DensePass",),
    "golden.dense_job": ("DenseJob", "DenseResult"),
    "golden.params": ("DENSE", "FULL", "NO_SCORE", "TINY", "Config"),
    "signum.applications.follow.eyes": ("DenseEye", "MotionEye", "RangeEye"),
    "signum.applications.follow.follower": ("Follower", "Target"),
    "signum.applications.mavlink.sink": ("MavlinkSink",),
    "signum.applications.hold.meter": ("StationMeter",),
    "signum.applications.hold.reading": ("Level", "Reading"),
    "signum.applications.mosaic.settings": ("SurveySettings",),
    "signum.applications.mosaic.survey": ("Survey",),
    "signum.applications.navigate.chart": ("Chart",),
    "signum.applications.navigate.localise": ("Localiser",),
    "signum.applications.navigate.place": ("LocaliseLimits", "Place"),
    "signum.boards": ("open_board",),
    "signum.boards.board": ("Board", "BoardError", "Identification", "run_jobs"),
    "signum.common.errors": ("SignumError", "SourceError"),
    "signum.frames.fit": ("Fit",),
    "signum.frames.frame": ("Frame", "Source", "read_picture"),
    "signum.geometry.calibration": ("read_mono", "read_stereo"),
    "signum.geometry.lens": ("Lens",),
    "signum.geometry.rig": ("Rectifier", "Rig", "StereoGeometry"),
    "signum.geometry.similarity": ("Similarity",),
    "signum.measure.background": ("Background",),
    "signum.measure.dense_flow": ("DenseFlowRules", "measure_dense_flow"),
    "signum.measure.dense_stereo": ("DenseStereoRules", "measure_dense_range"),
    "signum.measure.flow": ("FlowField", "measure_flow"),
    "signum.measure.measurer": ("Measurement", "Measurer", "Query", "View"),
    "signum.measure.moving": ("Moving", "MovingObject", "MovingRules", "segment_moving"),
    "signum.measure.peak": ("Peak", "locate_peaks"),
    "signum.measure.register": ("Registrar",),
    "signum.measure.registration": ("Registration", "RegistrationLimits"),
    "signum.measure.stereo": ("RangeMap", "measure_range"),
    "signum.measure.track": ("TrackPoint", "TrackSettings", "Tracker"),
    "signum.measure.validity": ("Reason", "Rules"),
    "signum.sources.open": ("open_lens", "open_rig", "open_source"),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}

if TYPE_CHECKING:
    from golden.correlate import Job, Result, Status, grid
    from golden.dense import DensePass
    from golden.dense_job import DenseJob, DenseResult
    from golden.params import DENSE, FULL, NO_SCORE, TINY, Config
    from signum.applications.follow.eyes import DenseEye, MotionEye, RangeEye
    from signum.applications.follow.follower import Follower, Target
    from signum.applications.hold.meter import StationMeter
    from signum.applications.hold.reading import Level, Reading
    from signum.applications.mavlink.sink import MavlinkSink
    from signum.applications.mosaic.settings import SurveySettings
    from signum.applications.mosaic.survey import Survey
    from signum.applications.navigate.chart import Chart
    from signum.applications.navigate.localise import Localiser
    from signum.applications.navigate.place import LocaliseLimits, Place
    from signum.boards import open_board
    from signum.boards.board import Board, BoardError, Identification, run_jobs
    from signum.common.errors import SignumError, SourceError
    from signum.frames.fit import Fit
    from signum.frames.frame import Frame, Source, read_picture
    from signum.geometry.calibration import read_mono, read_stereo
    from signum.geometry.lens import Lens
    from signum.geometry.rig import Rectifier, Rig, StereoGeometry
    from signum.geometry.similarity import Similarity
    from signum.measure.background import Background
    from signum.measure.dense_flow import DenseFlowRules, measure_dense_flow
    from signum.measure.dense_stereo import DenseStereoRules, measure_dense_range
    from signum.measure.flow import FlowField, measure_flow
    from signum.measure.measurer import Measurement, Measurer, Query, View
    from signum.measure.moving import Moving, MovingObject, MovingRules, segment_moving
    from signum.measure.peak import Peak, locate_peaks
    from signum.measure.register import Registrar
    from signum.measure.registration import Registration, RegistrationLimits
    from signum.measure.stereo import RangeMap, measure_range
    from signum.measure.track import Tracker, TrackPoint, TrackSettings
    from signum.measure.validity import Reason, Rules
    from signum.sources.open import open_lens, open_rig, open_source
else:
    def __getattr__(name: str) -> object:
        if name not in _HOME:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = globals()[name] = getattr(import_module(_HOME[name]), name)
        return value

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})
