# SPDX-License-Identifier: Apache-2.0
"""Where a camera is, and how it is turned: rotation matrices between world, body and camera.

World: x north, y east, z down, metres. Body: x forward, y right, z down. Camera: x right and y down in the image, z
along the optical axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signum.common.arrays import Floats

LOOK_DOWN: Floats = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Camera to body for a camera that looks down; image up is forward."""
LOOK_AHEAD: Floats = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Camera to body for a camera that looks forward, image upright."""


@dataclass(frozen=True, eq=False)
class Sight:
    """Where a camera is and how it is turned: position (3,) world metres, rotation (3, 3) camera to world."""

    position: Floats
    rotation: Floats

    def shifted(self, right: float) -> Sight:
        """The sight of a second camera `right` metres along this one's image x axis: a rectified stereo partner."""
        return Sight(self.position + self.rotation[:, 0] * right, self.rotation)


def rotation(roll: float, pitch: float, yaw: float) -> Floats:
    """Body to world matrix (3, 3), z-y-x convention, radians."""
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (np.cos, np.sin))
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]])


def pan_tilt(pan: float, tilt: float) -> Floats:
    """Matrix (3, 3) from a camera on a pan/tilt to the same camera at rest, angles in radians.

    A positive pan turns it right about the image's vertical; after that, a positive tilt turns it up.
    """
    cp, sp, ct, st = np.cos(pan), np.sin(pan), np.cos(tilt), np.sin(tilt)
    to_side = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    upward = np.array([[1.0, 0.0, 0.0], [0.0, ct, -st], [0.0, st, ct]])
    return np.asarray(to_side @ upward)
