# SPDX-License-Identifier: Apache-2.0
"""One picture of a demonstration flight: the camera's frame, its signs, flow, tracks, a held station, the mosaic."""

from __future__ import annotations

import io

import cv2
import numpy as np
from matplotlib import pyplot as plt

from signum.applications.hold.record import draw_reading
from signum.common.arrays import Image
from signum.demo.flight import DemoFlight
from signum.report.draw import draw_flow, draw_tracks

OVERVIEW_HEIGHT = 400
"""Height of the picture, pixels."""
PANEL_GAP = 8
"""Between panels, pixels."""
ENLARGED = 1.3
"""Scale at which the line of the reading fits into the frame."""


def overview(flight: DemoFlight) -> Image:
    """Panels side by side, uint8 (H, W, 3): a frame over its signs, flow over tracks, the last frame of the held
    station over the vehicle's path with and without control, the mosaic.

    Args:
        flight: a finished one.
    """
    assert flight.stage and flight.flow and flight.last is not None and flight.mosaic is not None
    frame, signs = flight.stage
    columns = [[frame, signs * np.uint8(255)],
               [draw_flow(flight.flow[0], flight.flow[2]), draw_tracks(flight.last, flight.points, flight.window)],
               [draw_held(flight), draw_paths(flight)],
               [flight.mosaic]]
    return np.asarray(np.hstack([_column(panels) for panels in columns])[:, :-PANEL_GAP], np.uint8)


def draw_held(flight: DemoFlight) -> Image:
    """The last frame of the held station with its reading, enlarged by ENLARGED; uint8 (H, W, 3)."""
    last, k = flight.held[-1], ENLARGED
    frame = np.asarray(cv2.resize(last.frame, None, fx=k, fy=k, interpolation=cv2.INTER_CUBIC), np.uint8)
    return draw_reading(frame, last.reading, k * (last.features + 0.5) - 0.5, round(k * flight.window))


def draw_paths(flight: DemoFlight) -> Image:
    """The vehicle's true path over ground with control (green, enlarged in the corner) and without (red); uint8 (384,
    512, 3)."""
    drawn, ax = plt.subplots(figsize=(5.12, 3.84), dpi=100)
    for moments, label, colour in ((flight.free, "drifting free", "tab:red"), (flight.held, "held", "tab:green")):
        forward, right = 100 * np.array([m.truth[:2] for m in moments]).T
        ax.plot(right, forward, color=colour, lw=2.5, label=label)
    ax.plot(0, 0, "k+", ms=14)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("right, cm", fontsize=13)
    ax.set_ylabel("ahead, cm", fontsize=13)
    ax.grid(alpha=0.3)
    ax.legend(fontsize=13, loc="upper left")
    zoomed = ax.inset_axes((0.6, 0.1, 0.38, 0.45))
    forward, right = 100 * np.array([m.truth[:2] for m in flight.held]).T
    zoomed.plot(right, forward, color="tab:green", lw=1.5)
    zoomed.plot(0, 0, "k+", ms=10)
    zoomed.set_aspect("equal", adjustable="datalim")
    zoomed.set_title("held", fontsize=12)
    drawn.tight_layout()
    png = io.BytesIO()
    drawn.savefig(png, format="png", dpi=100)
    plt.close(drawn)
    return np.asarray(cv2.imdecode(np.frombuffer(png.getvalue(), np.uint8), cv2.IMREAD_COLOR), np.uint8)


def _column(panels: list[Image]) -> Image:
    """Panels above one another, of equal height, OVERVIEW_HEIGHT pixels together; a gap to the right of the widest."""
    room = (OVERVIEW_HEIGHT - PANEL_GAP * (len(panels) - 1)) // len(panels)
    shown = []
    for panel in panels:
        colour = panel if panel.ndim == 3 else np.asarray(cv2.cvtColor(panel, cv2.COLOR_GRAY2BGR), np.uint8)
        width = round(colour.shape[1] * room / colour.shape[0])
        fitted = np.asarray(cv2.resize(colour, (width, room), interpolation=cv2.INTER_AREA), np.uint8)
        shown.append(fitted)
    widest = max(panel.shape[1] for panel in shown)
    shown = [np.asarray(cv2.copyMakeBorder(p, 0, PANEL_GAP, 0, PANEL_GAP + widest - p.shape[1], cv2.BORDER_CONSTANT,
                                           value=(255, 255, 255)), np.uint8) for p in shown]
    return np.asarray(np.vstack(shown)[:OVERVIEW_HEIGHT], np.uint8)
