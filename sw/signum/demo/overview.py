"""One picture of a demonstration flight: what the camera sees, what the board keeps, what is measured, the mosaic."""

from __future__ import annotations

import cv2
import numpy as np

from signum.common.arrays import Image
from signum.demo.flight import Flight
from signum.measure.flow import draw_flow
from signum.report.draw import draw_tracks

HEIGHT = 400
GAP = 8


def overview(flight: Flight) -> Image:
    """Panels side by side, uint8 (H, W, 3): a frame over its signs, flow over tracks, the mosaic.

    Args:
        flight: a finished one.
    """
    assert flight.stage and flight.flow and flight.last is not None and flight.mosaic is not None
    frame, signs = flight.stage
    columns = [[frame, signs * np.uint8(255)],
               [draw_flow(flight.flow[0], flight.flow[2]), draw_tracks(flight.last, flight.points, flight.window)],
               [flight.mosaic]]
    return np.asarray(np.hstack([_column(panels) for panels in columns])[:, :-GAP], np.uint8)


def _column(panels: list[Image]) -> Image:
    """Panels above one another, all as wide, HEIGHT pixels high together, with a gap to the right."""
    room = (HEIGHT - GAP * (len(panels) - 1)) // len(panels)
    shown = []
    for panel in panels:
        colour = panel if panel.ndim == 3 else np.asarray(cv2.cvtColor(panel, cv2.COLOR_GRAY2BGR), np.uint8)
        width = round(colour.shape[1] * room / colour.shape[0])
        fitted = np.asarray(cv2.resize(colour, (width, room), interpolation=cv2.INTER_AREA), np.uint8)
        shown.append(cv2.copyMakeBorder(fitted, 0, GAP, 0, GAP, cv2.BORDER_CONSTANT, value=(255, 255, 255)))
    return np.asarray(np.vstack(shown)[:HEIGHT], np.uint8)
