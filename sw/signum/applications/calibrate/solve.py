# SPDX-License-Identifier: Apache-2.0
"""The camera, or the pair, that explains the views of a board: OpenCV's calibration, without views that do not fit.

The pair is found with the cameras as they are, from the rays of their corners, so that it is the same for a pinhole and
a fisheye lens.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import cv2
import numpy as np
from scipy.optimize import least_squares

from signum.applications.calibrate.target import Sighting
from signum.common.arrays import Floats
from signum.common.errors import SignumError
from signum.geometry.lens import Lens
from signum.geometry.rig import Rig

LEAST_VIEWS = 4
"""Fewest views of which a camera is computed."""
OUTLYING = 3.0
"""A view is left out if its residual is so many times the median one, and over OUTLYING_PX."""
OUTLYING_PX = 0.3
"""Residual of a view up to which it is used in any case, pixels."""
MOST_TRIMMED = 0.1
"""Share of a view's corners that may be left out; with more the view itself is in question."""
OFTEN = cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-9
"""When the calibration has converged: steps, and change."""


class LensModel(StrEnum):
    """OpenCV's models of a lens."""

    pinhole = "pinhole"
    rational = "rational"
    fisheye = "fisheye"


@dataclass(frozen=True, eq=False)
class LensFit:
    """A camera, and how well it explains the views.

    Attributes:
        lens: the camera.
        views: the corners, without single ones that lie far from the computed ones.
        used: numbers of the views it was computed from.
        turns: of every view's board (n, 3), rotation vector to the camera's axes.
        moves: of every view's board (n, 3), translation, metres.
        residuals: of every view, seen corner less the computed one, pixels (corners, 2).
        focal_error_px: standard deviation of the focal length by the residuals; NaN where it is not known.
    """

    lens: Lens
    views: list[Sighting]
    used: list[int]
    turns: Floats
    moves: Floats
    residuals: list[Floats]
    focal_error_px: float

    @property
    def rms_px(self) -> float:
        """Root-mean-square distance of the corners of the used views from the computed ones."""
        return _rms([self.residuals[k] for k in self.used])

    def tilts_deg(self) -> Floats:
        """Angle of each board's normal to the optical axis (n,)."""
        return np.array([np.degrees(np.arccos(min(1.0, abs(float(np.asarray(cv2.Rodrigues(t)[0])[2, 2])))))
                         for t in self.turns])


@dataclass(frozen=True, eq=False)
class RigFit:
    """A pair, and how well it explains the views.

    Attributes:
        rig: the pair, T in metres.
        used: numbers of the views it was computed from.
        rms_px: of the used views' corners in both pictures, from the board's computed place.
        rows_px: median difference of a corner's rows in the rectified pair.
    """

    rig: Rig
    used: list[int]
    rms_px: float
    rows_px: float


def fit_lens(views: Sequence[Sighting], size: tuple[int, int], model: LensModel) -> LensFit:
    """Compute a camera from views of a board.

    Args:
        views: the corners, of LEAST_VIEWS views or more.
        size: width and height of the pictures, pixels.
        model: of the lens.

    Raises:
        SignumError: if they are too few, or no camera explains them.
    """
    kept, used = list(views), list(range(len(views)))
    for step in range(4):
        if len(used) < LEAST_VIEWS:
            raise SignumError(f"{len(used)} views of the board that fit together; {LEAST_VIEWS} are needed, 15 are "
                              "good: move and tilt the board, and check its squares")
        lens, error = _calibrate([kept[k] for k in used], size, model)
        turns, moves, residuals = _places(kept, lens)
        if step == 0:
            trimmed = _trimmed(kept, residuals)
            if any(len(a.ids) != len(b.ids) for a, b in zip(kept, trimmed, strict=True)):
                kept = trimmed
                continue
        each = np.array([_rms([r]) for r in residuals])
        limit = max(OUTLYING_PX, OUTLYING * float(np.median(each[used])))
        fitting = [k for k in used if each[k] <= limit]
        if fitting == used:
            break
        used = fitting
    return LensFit(lens, kept, used, turns, moves, residuals, error)


def _trimmed(views: list[Sighting], residuals: list[Floats]) -> list[Sighting]:
    """The views without single corners that were found at a wrong place; a view with many such stays as it is."""
    sizes = [np.hypot(*r.T) for r in residuals]
    limit = max(2 * OUTLYING_PX, OUTLYING * float(np.median(np.concatenate(sizes))))
    out = []
    for view, size in zip(views, sizes, strict=True):
        good = size <= limit
        few = int((~good).sum()) <= MOST_TRIMMED * len(good)
        out.append(Sighting(view.ids[good], view.points[good], view.corners[good]) if few else view)
    return out


def _calibrate(views: Sequence[Sighting], size: tuple[int, int], model: LensModel) -> tuple[Lens, float]:
    """The camera, and the standard deviation of its focal length."""
    points = [v.points.astype(np.float32).reshape(-1, 1, 3) for v in views]
    corners = [v.corners.astype(np.float32).reshape(-1, 1, 2) for v in views]
    error = float("nan")
    try:
        if model is LensModel.fisheye:
            flags = _fisheye_flag("CALIB_RECOMPUTE_EXTRINSIC") | _fisheye_flag("CALIB_FIX_SKEW")
            _, matrix, distortion, *_ = cv2.fisheye.calibrate(
                [v.points.reshape(1, -1, 3) for v in views], [v.corners.reshape(1, -1, 2) for v in views], size,
                np.eye(3), np.zeros((4, 1)), flags=flags, criteria=OFTEN)
        else:
            flags = cv2.CALIB_RATIONAL_MODEL if model is LensModel.rational else 0
            _, matrix, distortion, _, _, spread, *_ = cv2.calibrateCameraExtended(
                points, corners, size, np.eye(3), np.zeros(5), flags=flags, criteria=OFTEN)
            error = float(np.asarray(spread).ravel()[0])
    except cv2.error as reason:
        raise SignumError(f"no {model} camera explains these views of the board ({reason.err or reason}): check "
                          "--across, --down and --model, and take more views, tilted to all sides") from reason
    numbers = np.asarray(distortion, np.float64).ravel()
    lens = Lens(np.asarray(matrix, np.float64), numbers[:8] if model is LensModel.rational else numbers, size,
                model is LensModel.fisheye)
    if not (np.isfinite(lens.matrix).all() and np.isfinite(numbers).all() and 0 < lens.focal < 100 * max(size)):
        raise SignumError(f"no {model} camera explains these views of the board (focal length {lens.focal:g} px): take "
                          "more views, tilted in all directions")
    return lens, error


def _places(views: Sequence[Sighting], lens: Lens) -> tuple[Floats, Floats, list[Floats]]:
    """Rotation vector and translation of each view's board, and its residuals."""
    turns, moves, residuals = [], [], []
    for view in views:
        rays = lens.rays(view.corners)
        found, turn, move = cv2.solvePnP(view.points, rays, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE)
        start = np.concatenate([np.ravel(turn), np.ravel(move)]) if found else np.array([0, 0, 0, 0, 0, 1.0])
        refined = least_squares(_missed, start, method="lm", args=(view, lens)).x
        turns.append(refined[:3])
        moves.append(refined[3:])
        residuals.append(-_missed(refined, view, lens).reshape(-1, 2))
    return np.array(turns), np.array(moves), residuals


def _missed(place: Floats, view: Sighting, lens: Lens) -> Floats:
    """Computed less seen pixels (2 n,) of a board at a place: rotation vector and translation (6,)."""
    return (lens.project(view.points, place[:3], place[3:]) - view.corners).ravel()


def _fisheye_flag(name: str) -> int:
    """A flag of OpenCV's fisheye calibration, which OpenCV 4 and 5 keep in different places."""
    return int(getattr(cv2.fisheye, name, getattr(cv2, name, 0)))


def fit_rig(views: Sequence[tuple[Sighting, Sighting]], left: Lens, right: Lens) -> RigFit:
    """Compute how the second camera sits beside the first, from corners that both see.

    Args:
        views: the same corners in both pictures, of LEAST_VIEWS views or more.
        left: the first camera.
        right: the second camera.

    Raises:
        SignumError: if they are too few, or no pair explains them.
    """
    rays = [(left.rays(a.corners), right.rays(b.corners)) for a, b in views]
    used = list(range(len(views)))
    for _ in range(3):
        if len(used) < LEAST_VIEWS:
            raise SignumError(f"{len(used)} views of the board by both cameras that fit together; {LEAST_VIEWS} are "
                              "needed, 15 are good: are the frames of the same moments?")
        eye, none = np.eye(3), np.zeros(5)
        _, _, _, _, _, turn, move, *_ = cv2.stereoCalibrate(
            [views[k][0].points.astype(np.float32) for k in used], [rays[k][0].astype(np.float32) for k in used],
            [rays[k][1].astype(np.float32) for k in used], eye, none, eye, none, left.size,
            flags=cv2.CALIB_FIX_INTRINSIC, criteria=OFTEN)
        rig = Rig(left, right, np.asarray(turn, np.float64), np.asarray(move, np.float64).ravel(), "calibration")
        residuals = [_pair_residual(rig, pair) for pair in views]
        each = np.array([_rms([r]) for r in residuals])
        limit = max(OUTLYING_PX, OUTLYING * float(np.median(each[used])))
        fitting = [k for k in used if each[k] <= limit]
        if fitting == used:
            break
        used = fitting
    return RigFit(rig, used, _rms([residuals[k] for k in used]), _rows_px(rig, [rays[k] for k in used]))


def _pair_residual(rig: Rig, pair: tuple[Sighting, Sighting]) -> Floats:
    """Corners of both pictures less those of the board where the first camera sees it (2 n, 2)."""
    one, two = pair
    (turn,), (move,), (first,) = _places([one], rig.first)
    around = np.asarray(cv2.Rodrigues(turn)[0], np.float64)
    second = two.corners - rig.second.project(one.points, rig.turn @ around, rig.turn @ move + rig.move)
    return np.concatenate([first, second])


def _rows_px(rig: Rig, rays: Sequence[tuple[Floats, Floats]]) -> float:
    """Median difference of a point's rows in the rectified pair, pixels."""
    eye, none = np.eye(3), np.zeros(5)
    one, two, *_ = cv2.stereoRectify(eye, none, eye, none, rig.first.size, rig.turn, rig.move.reshape(3, 1))
    rows = []
    for pair in rays:
        left, right = (np.c_[r, np.ones(len(r))] @ np.asarray(turn).T for r, turn in zip(pair, (one, two), strict=True))
        rows.append(left[:, 1] / left[:, 2] - right[:, 1] / right[:, 2])
    return float(np.median(np.abs(np.concatenate(rows))) * rig.first.focal)


def _rms(residuals: Sequence[Floats]) -> float:
    return float(np.sqrt((np.concatenate(residuals) ** 2).sum(1).mean()))
