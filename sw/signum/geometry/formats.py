# SPDX-License-Identifier: Apache-2.0
"""Cameras and pairs from the entries of a calibration, by the names that OpenCV, ROS and Kalibr give them.

Sources of the names: OpenCV's sample camera_calibration.cpp (`camera_matrix`, `distortion_coefficients`,
`fisheye_model`) and stereo_calib.cpp (`M1` or `K1`, `D1`, ..., `R`, `T`); ROS' sensor_msgs/CameraInfo (fields d, k, r,
p, capitals in ROS 1, `distortion_model`, `binning_x`, `roi`) and its YAML file (`camera_matrix`, `projection_matrix`,
`rectification_matrix`); Kalibr's camchain.yaml (`cam0`, `intrinsics`, `distortion_model`, `T_cn_cnm1`).
"""

from __future__ import annotations

import numpy as np

from signum.common.arrays import Floats
from signum.geometry.document import LARGEST_PX, Entries
from signum.geometry.lens import CalibrationError, Lens
from signum.geometry.rig import LONGEST_NUMBER, ROTATION_ERROR, Rig

PINHOLE = "", "plumb_bob", "radtan", "rational_polynomial", "none"
"""Distortion models that are OpenCV's pinhole model, by the names of ROS and Kalibr."""
FISHEYE = "equidistant", "fisheye", "kannala_brandt", "kannala_brandt4"
"""Distortion models that are OpenCV's fisheye model."""


def lens_of(entries: Entries) -> Lens:
    """A single camera; of Kalibr's file, which must have one camera only, or of a pair's in OpenCV's the left one.

    Raises:
        CalibrationError: if an entry is missing, or is not what a camera has.
    """
    if entries.has("cam0"):
        if entries.has("cam1"):
            raise CalibrationError(f"{entries.label}: has several cameras; name one, e.g. '{entries.label}#cam0'")
        return kalibr_lens(entries.below("cam0"))
    names = ("camera_matrix", "K", "k"), ("distortion_coefficients", "D", "d")
    if not any(entries.has(name) for name in names[0]) and (entries.has("K1") or entries.has("M1")):
        raise CalibrationError(f"{entries.label}: has no camera_matrix or K, only a pair (K1, K2): give the "
                               "calibration of the one camera")
    fisheye = _is_fisheye(entries)
    distortion = entries.distortion(*names[1], fisheye=fisheye)
    lens = Lens(entries.camera(*names[0]), distortion, entries.size(), fisheye)
    return _as_sent(lens, entries)


def kalibr_lens(entries: Entries) -> Lens:
    """A camera of Kalibr's file.

    Raises:
        CalibrationError: if an entry is missing, or is not what a camera has.
    """
    model = entries.text("camera_model")
    if model != "pinhole":
        raise CalibrationError(f"{entries.label}: camera_model is {model or 'not given'}; expected pinhole: calibrate "
                               "with pinhole-radtan, or pinhole-equi for a fisheye lens")
    fx, fy, cx, cy = entries.matrix(("intrinsics",), [(4,)], LARGEST_PX)
    matrix = Entries({"intrinsics": [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]}, entries.label).camera("intrinsics")
    width, height = entries.matrix(("resolution",), [(2,)], LARGEST_PX)
    size = Entries({"width": float(width), "height": float(height)}, f"{entries.label}: resolution").size()
    fisheye = _is_fisheye(entries)
    without = entries.text("distortion_model") == "none" and not entries.has("distortion_coeffs")
    distortion = np.zeros(5) if without else entries.distortion("distortion_coeffs", fisheye=fisheye)
    return Lens(matrix, distortion, size, fisheye)


def rig_of(entries: Entries) -> Rig:
    """A pair, of one file: OpenCV's `K1 D1 K2 D2 R T` (or `M1 ... M2`), or Kalibr's `cam0` and `cam1`.

    Raises:
        CalibrationError: if an entry is missing, or is not what a pair has.
    """
    if entries.has("cam0", "cam1"):
        one, other = (kalibr_lens(entries.below(name)) for name in ("cam0", "cam1"))
        pose = entries.below("cam1").matrix(("T_cn_cnm1",), [(4, 4)], LONGEST_NUMBER)
        return Rig(one, other, _rotation(pose[:3, :3], f"{entries.label}: cam1: T_cn_cnm1"), pose[:3, 3], entries.label)
    if entries.has("cam0"):
        raise CalibrationError(f"{entries.label}: has one camera; a pair has cam0 and cam1")
    k1, k2 = entries.camera("K1", "M1"), entries.camera("K2", "M2")
    fisheye = _is_fisheye(entries)
    d1, d2 = entries.distortion("D1", fisheye=fisheye), entries.distortion("D2", fisheye=fisheye)
    turn = _rotation(entries.matrix(("R",), [(3, 3)], 1.0 + ROTATION_ERROR), f"{entries.label}: R")
    move = entries.matrix(("T",), [(3,), (3, 1), (1, 3)], LONGEST_NUMBER).ravel()
    size = entries.size()
    return Rig(Lens(k1, d1, size, fisheye), Lens(k2, d2, size, fisheye), turn, move, entries.label)


def rig_of_two(left: Entries, right: Entries) -> Rig:
    """A pair of two cameras as ROS calibrates it: each has a rectification matrix R and a projection matrix P, and the
    right one's P the baseline.

    Raises:
        CalibrationError: if an entry is missing, or is not what a camera of a pair has.
    """
    one, other = lens_of(left), lens_of(right)
    turns, places = [], []
    for entries in (left, right):
        turn = entries.matrix(("rectification_matrix", "R", "r"), [(3, 3), (9,)], 1.0 + ROTATION_ERROR).reshape(3, 3)
        turns.append(_rotation(turn, f"{entries.label}: rectification matrix"))
        p = entries.matrix(("projection_matrix", "P", "p"), [(3, 4), (12,)], LARGEST_PX * LONGEST_NUMBER).reshape(3, 4)
        if not p[0, 0] > 0:
            raise CalibrationError(f"{entries.label}: projection matrix has a focal length of {p[0, 0]:g}; expected "
                                   "that of a calibrated pair")
        places.append(p[:, 3] / p[0, 0])
    if not (places[1] - places[0]).any():
        raise CalibrationError(f"{left.label} and {right.label}: their projection matrices have no baseline: they are "
                               "of two single cameras; calibrate them as a pair")
    turn = turns[1].T @ turns[0]
    return Rig(one, other, turn, turns[1].T @ (places[1] - places[0]), f"{left.label} and {right.label}")


def _is_fisheye(entries: Entries) -> bool:
    """Whether the coefficients are of the fisheye model.

    Raises:
        CalibrationError: for a model that OpenCV has not.
    """
    model = entries.text("distortion_model")
    if model not in (*PINHOLE, *FISHEYE):
        raise CalibrationError(f"{entries.label}: distortion_model is {model!r}; expected one of "
                               f"{', '.join(filter(None, (*PINHOLE, *FISHEYE)))}: calibrate with one of these")
    return model in FISHEYE or (not model and bool(entries.whole("fisheye_model")))


def _as_sent(lens: Lens, entries: Entries) -> Lens:
    """The camera as ROS' driver sends its pictures: a part of the view, or pixels joined, if the message says so."""
    if entries.has("roi"):
        roi = entries.below("roi")
        size = roi.whole("width"), roi.whole("height")
        if all(size) and size != lens.size:
            lens = lens.cropped(roi.whole("x_offset"), roi.whole("y_offset"), size)
    across, down = (max(1, entries.whole(f"binning_{axis}")) for axis in "xy")
    if (across, down) == (1, 1):
        return lens
    if across > lens.size[0] or down > lens.size[1]:
        raise CalibrationError(f"{entries.label}: binning of {across} x {down} pixels, which a picture of "
                               f"{lens.size[0]}x{lens.size[1]} has not")
    return lens.binned(across, down)


def _rotation(turn: Floats, label: str) -> Floats:
    """The rotation that is nearest to a matrix that is one but for rounding.

    Raises:
        CalibrationError: if it is none.
    """
    if np.abs(turn @ turn.T - np.eye(3)).max() > ROTATION_ERROR or np.linalg.det(turn) < 0:
        raise CalibrationError(f"{label} is no rotation; expected orthogonal rows of length 1")
    u, _, v = np.linalg.svd(turn)
    return np.asarray(u @ v, np.float64)
