"""How a camera looks and turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signum.common.arrays import Floats


def rotation(roll: float, pitch: float, yaw: float) -> Floats:
    """Body to world matrix (3, 3), z-y-x convention, radians."""
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (np.cos, np.sin))
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]])


LOOK_DOWN: Floats = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Camera (right, down in the image, along the axis) to body (forward, right, down): image up is forward."""


LOOK_AHEAD: Floats = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Camera to body with the axis forward and the image upright."""



def pan_tilt(pan: float, tilt: float) -> Floats:
    """Camera on a pan/tilt to the same camera at rest (3, 3): pan turns right about the image's vertical, then tilt
    looks up; radians."""
    cp, sp, ct, st = np.cos(pan), np.sin(pan), np.cos(tilt), np.sin(tilt)
    to_side = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    upward = np.array([[1.0, 0.0, 0.0], [0.0, ct, -st], [0.0, st, ct]])
    return np.asarray(to_side @ upward)



@dataclass(frozen=True, eq=False)
class Sight:
    """Where a camera is and how it is turned: position (3,) world metres, rotation (3, 3) camera to world."""

    position: Floats
    rotation: Floats

    def shifted(self, right: float) -> Sight:
        """The sight of a second camera `right` metres along this one's image x axis: a rectified stereo partner."""
        return Sight(self.position + self.rotation[:, 0] * right, self.rotation)
