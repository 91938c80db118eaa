# SPDX-License-Identifier: Apache-2.0
"""Rows of the tables, made from measurements; `read_table.py` reads tables back."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.geometry.calibration import StereoGeometry
from signum.measure.flow import FlowField
from signum.measure.moving import Moving
from signum.measure.stereo import RangeMap
from signum.measure.track import TrackPoint


def seconds(time: float | None) -> str:
    """A time in a table, to the microsecond; empty where there is none."""
    return "" if time is None else f"{time:.6f}"


def flow_rows(a: Frame, b: Frame, field: FlowField, fit: Fit) -> tuple[list[object], Iterator[str]]:
    """Rows of `flow.csv` from a field in pixels of the board's picture, as `Table.write_numbers` takes them."""
    return _pair_cells(a, b), _flow_numbers(field, fit.factor)


def _flow_numbers(field: FlowField, factor: tuple[float, float]) -> Iterator[str]:
    kx, ky = factor
    xs = [f"{(x + 0.5) * kx - 0.5:.1f}" for x in field.x.tolist()]
    for y, valid, *values in zip(field.y.tolist(), field.valid.tolist(), (field.dx * kx).tolist(),
                                 (field.dy * ky).tolist(), field.score.tolist(), strict=True):
        down = f"{(y + 0.5) * ky - 0.5:.1f}"
        for x, good, dx, dy, score in zip(xs, valid, *values, strict=True):
            yield f"{x},{down},{dx:.3f},{dy:.3f},{score:.4f},1" if good else f"{x},{down},,,{score:.4f},0"


def moving_rows(a: Frame, b: Frame, moving: Moving, fit: Fit) -> Iterator[list[object]]:
    """Rows of `moving.csv` from objects in pixels of the board's picture."""
    head, (kx, ky) = _pair_cells(a, b), fit.factor
    for n, one in enumerate(moving.objects, 1):
        centre = f"{(one.x + 0.5) * kx - 0.5:.1f}", f"{(one.y + 0.5) * ky - 0.5:.1f}"
        box = (f"{side * k:.0f}" for side, k in ((one.left, kx), (one.top, ky), (one.width, kx), (one.height, ky)))
        moved = (f"{d * k:.3f}" for d, k in ((one.dx, kx), (one.dy, ky), (one.own_dx, kx), (one.own_dy, ky)))
        yield [*head, n, *centre, *box, f"{one.area * kx * ky:.0f}", *moved, f"{one.score:.4f}", f"{one.margin:.4f}",
               one.confidence]


def _pair_cells(a: Frame, b: Frame) -> list[object]:
    """How a row begins that is of two frames."""
    step = None if a.time_s is None or b.time_s is None else b.time_s - a.time_s
    return [a.name, b.name, seconds(b.time_s), seconds(step)]


def disparity_rows(frame: Frame, found: RangeMap, geometry: StereoGeometry | None) -> Iterator[list[object]]:
    """Rows of `disparity.csv` from a map in original pixels."""
    depth = np.full(found.disparity.shape, np.nan) if geometry is None else geometry.depth(found.disparity)
    for j, y in enumerate(found.y):
        for i, x in enumerate(found.x):
            figures = ["" if np.isnan(v) else f"{v:.4f}" for v in (found.disparity[j, i], depth[j, i])]
            yield [frame.name, seconds(frame.time_s), f"{x:.1f}", f"{y:.1f}", *figures, f"{found.score[j, i]:.4f}",
                   f"{found.margin[j, i]:.4f}", int(found.valid[j, i])]


def drift_row(frame: Frame, points: Sequence[TrackPoint], fit: Fit) -> list[object]:
    """A row of `drift.csv`."""
    valid = [p for p in points if p.valid]
    worst = max((p.error_px for p in valid), default=0.0) * max(fit.factor)
    figures = [str(max(p.links for p in valid)), f"{worst:.3f}"] if valid else ["", ""]
    return [frame.name, seconds(frame.time_s), len(valid), sum(p.links <= 1 for p in valid), *figures]


def track_row(frame: Frame, point: TrackPoint, fit: Fit) -> list[object]:
    """A row of `track.csv` from a point in pixels of the board's picture."""
    kx, ky = fit.factor
    x, y = (point.x + 0.5) * kx - 0.5, (point.y + 0.5) * ky - 0.5
    figures = [f"{v:.3f}" for v in (x, y, point.dx * kx, point.dy * ky)]
    return [frame.name, seconds(frame.time_s), point.feature, *figures, f"{point.score:.4f}", f"{point.margin:.4f}",
            int(point.valid)]
