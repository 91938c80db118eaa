# SPDX-License-Identifier: Apache-2.0
"""Rectification of a stereo pair: ranges measured through it lie on the floor they are of."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from signum.boards.golden import GoldenBoard
from signum.geometry.calibration import CalibrationError, read_stereo
from signum.geometry.camera import LOOK_DOWN, Sight
from signum.geometry.lens import Lens
from signum.geometry.rig import Rig
from signum.measure.measurer import Measurer
from signum.measure.stereo import measure_range
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.world import World

BASELINE = 0.12
CAMERA = Pinhole(focal=400.0)


def test_calibration_rectifies(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    storage.write("image_width", 384)
    storage.write("image_height", 288)
    k = np.array([[400.0, 0, 191.5], [0, 400.0, 143.5], [0, 0, 1]])
    turn = cv2.Rodrigues(np.array([0.01, -0.02, 0.015]))[0]
    for name, value in (("K1", k), ("K2", k), ("D1", np.zeros(5)), ("D2", np.zeros(5)), ("R", turn),
                        ("T", -turn @ np.array([[BASELINE], [0], [0]]))):
        storage.write(name, value)
    storage.release()
    rectifier = read_stereo(path)
    assert rectifier.geometry.baseline == pytest.approx(BASELINE, abs=1e-3)
    world = World(Seafloor(extent=4.0, texel=0.0025))
    left = Sight(np.array([0, 0, -2.0]), LOOK_DOWN)
    right = Sight(left.position + left.rotation[:, 0] * BASELINE, left.rotation @ turn.T)
    frames = rectifier(*(world.look(CAMERA, s).frame for s in (left, right)))
    measurer = Measurer(GoldenBoard(), CAMERA.size, 1.0)
    points = measure_range(measurer, *measurer.pair(*frames), (4, 48), (32, 32)).points(rectifier.geometry)
    assert len(points) > 100
    flat = np.linalg.lstsq(np.c_[points[:, :2], np.ones(len(points))], points[:, 2], rcond=None)
    assert np.sqrt(flat[1][0] / len(points)) < 0.01
    with pytest.raises(CalibrationError, match="is for 384x288"):
        rectifier(frames[0][:100], frames[1][:100])
    with pytest.raises(CalibrationError, match=r"no such file.*\(expected: calibration\)"):
        read_stereo(tmp_path / "none.yaml")


@pytest.mark.parametrize(("fisheye", "turn", "given"), [(False, 0.0, True), (False, 0.01, False), (True, 0.0, False)])
def test_a_pair_that_needs_no_rectification_has_its_own_geometry(fisheye: bool, turn: float, given: bool) -> None:
    """A fisheye lens without coefficients is not a pinhole: its pictures are bent."""
    lenses = [Lens(np.array([[400.0, 0, x], [0, 400.0, 143.5], [0, 0, 1]]), np.zeros(4), (384, 288), fisheye)
              for x in (191.5, 199.5)]
    axes = np.asarray(cv2.Rodrigues(np.array([0, turn, 0]))[0], np.float64)
    rig = Rig(lenses[0], lenses[1], axes, np.array([-BASELINE, 0, 0]), "rig")
    own = rig.rectifier().given
    assert (own is not None) == given
    if own:
        assert (own.focal, own.baseline, own.shift) == (400, BASELINE, 8) and own.centre == (191.5, 143.5)
