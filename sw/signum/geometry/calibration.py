# SPDX-License-Identifier: Apache-2.0
"""Camera calibration from files of OpenCV, ROS and Kalibr: the lens of one camera, and the rectification of a pair; and
what `signum calibrate` writes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import cv2
import numpy as np

from signum.common.arrays import Floats
from signum.geometry.document import read_entries
from signum.geometry.formats import kalibr_lens, lens_of, rig_of
from signum.geometry.lens import CalibrationError, Lens
from signum.geometry.rig import Rectifier, Rig, StereoGeometry

__all__ = ["CalibrationError", "Lens", "Rectifier", "Rig", "StereoGeometry", "calibration_text", "read_lens",
           "read_mono", "read_rig", "read_stereo"]


def read_lens(path: Path, camera: str = "") -> Lens:
    """A single camera, of whatever lens.

    Args:
        path: YAML, XML or JSON of OpenCV (`camera_matrix`, `distortion_coefficients`, or `K` and `D`; `fisheye_model`),
            YAML of ROS' camera_info, or Kalibr's camchain.yaml.
        camera: its name in a file of several: `cam1`.

    Raises:
        CalibrationError: if the file or an entry is missing, or an entry is not what a camera has.
    """
    entries = read_entries(path)
    return kalibr_lens(entries.below(camera)) if camera else lens_of(entries)


def read_mono(path: Path) -> tuple[Floats, Floats, tuple[int, int]]:
    """Camera matrix (3, 3), distortion coefficients (n,) of OpenCV's pinhole model and image size of a single camera.

    For a fisheye lens, whose coefficients mean something else, take `open_lens`, which gives all of it as one `Lens`.

    Raises:
        CalibrationError: if the file or an entry is missing, an entry is not what a camera has, or it is a fisheye
            lens.
    """
    lens = read_lens(path)
    if lens.fisheye:
        raise CalibrationError(f"{path}: is of a fisheye lens, whose coefficients are not those of the pinhole model: "
                               "open it with open_lens")
    return lens.matrix, lens.distortion, lens.size


def read_rig(path: Path) -> Rig:
    """The two cameras of a stereo calibration: OpenCV's `K1 D1 K2 D2 R T` (or `M1 ... M2`) or Kalibr's camchain.yaml.

    Raises:
        CalibrationError: if the file or an entry is missing, or an entry is not what a pair has.
    """
    return rig_of(read_entries(path))


def read_stereo(path: Path, size: tuple[int, int] | None = None) -> Rectifier:
    """Rectifier of a stereo calibration; see `read_rig` for the files. T is in metres; millimetres, and cameras in the
    other order, are recognised and said.

    Args:
        path: of the file.
        size: width and height of the frames, by default those of the calibration.

    Raises:
        CalibrationError: if the file or an entry is missing, an entry is not what a pair has, the cameras do not sit
            side by side, or frames of this size have another aspect than the calibration's.
    """
    return read_rig(path).rectifier(size)


def calibration_text(lens: Lens, rig: Rig | None = None, figures: Mapping[str, float | str] | None = None) -> str:
    """A calibration as OpenCV's YAML, which the functions above read.

    Args:
        lens: the camera, of a pair the left one.
        rig: the pair; T is in metres.
        figures: more numbers and texts for the reader of the file, by their names.
    """
    storage = cv2.FileStorage("calibration.yaml", cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    storage.write("image_width", lens.size[0])
    storage.write("image_height", lens.size[1])
    if lens.fisheye:
        storage.write("fisheye_model", 1)
    values: dict[str, Floats] = {"camera_matrix": lens.matrix, "distortion_coefficients": lens.distortion[None]}
    if rig is not None:
        values |= {"K1": rig.first.matrix, "D1": rig.first.distortion[None], "K2": rig.second.matrix,
                   "D2": rig.second.distortion[None], "R": rig.turn, "T": rig.move.reshape(3, 1)}
    for name, value in values.items():
        storage.write(name, np.asarray(value, np.float64))
    for name, figure in (figures or {}).items():
        storage.write(name, figure)
    return str(storage.releaseAndGetString())
