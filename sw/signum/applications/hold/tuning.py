# SPDX-License-Identifier: Apache-2.0
"""How the station keeper's PID gains are found: the largest integral gain that keeps the loop's sensitivity bounded.

An axis is an inertia with drag, pushed through a thruster with lag and, in yaw, damped by the autopilot through the
same thruster. Frames come at a fixed rate and the force is held in between. A current with surge is a load at low
frequency, which the integral gain rejects; the peak |1/(1+L)| of the sensitivity bounds what the loop adds at higher
frequencies and how far it is from instability (2: a phase margin of 29 degrees or more, a gain margin of 2 or
more). The method is that of Åström and Hägglund's MIGO: maximise the integral gain subject to the peaks of |1/(1+L)|
and |L/(1+L)|.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from signum.common.arrays import Complexes, Floats

PEAK = 2.0
"""Upper bound of both sensitivity peaks."""


@dataclass(frozen=True)
class Axis:
    """The dynamics of an axis.

    Attributes:
        inertia: kg or kg m^2, added mass included; drag: N s/m or N m s at the speeds of station keeping.
        limit: N or N m.
        damper: N m s of a rate feedback that acts through the thruster.
        lag: of the thruster, seconds; period: between two frames, seconds.
    """

    inertia: float
    drag: float
    limit: float
    damper: float = 0.0
    lag: float = 0.15
    period: float = 0.1


def loop(axis: Axis, gains: tuple[float, float, float], points: int = 400
         ) -> tuple[Floats, Complexes]:
    """Frequencies (points,) rad/s up to the Nyquist frequency, and the open loop's response there.

    Args:
        gains: proportional, integral and rate gain of the sampled PID.
    """
    w = np.logspace(-1.5, np.log10(0.98 * np.pi / axis.period), points)
    s = 1j * w
    thruster = 1 / (axis.lag * s + 1)
    plant = thruster / (axis.inertia * s + axis.drag + axis.damper * thruster) / s
    back = np.exp(-s * axis.period)
    pid = gains[0] + gains[1] * axis.period / (1 - back) + gains[2] * (1 - back) / axis.period
    return w, np.asarray(pid * plant * (1 - back) / (s * axis.period))


@lru_cache(maxsize=16)
def _sampled(axis: Axis) -> tuple[Floats, Floats]:
    """Transition (3, 3) of position, speed and thrust from frame to frame, and the input (3, 1) of a held force."""
    from scipy.signal import cont2discrete  # loads for a second, which every command would pay

    a = np.array([[0, 1, 0], [0, -axis.drag / axis.inertia, 1 / axis.inertia],
                  [0, -axis.damper / axis.lag, -1 / axis.lag]])
    push = np.array([[0.0], [0.0], [1 / axis.lag]])
    phi, gamma, *_ = cont2discrete((a, push, np.eye(3), np.zeros((3, 1))), axis.period)
    return phi, gamma


def stable(axis: Axis, gains: tuple[float, float, float]) -> bool:
    """Whether the sampled closed loop is stable: its poles lie within the unit circle."""
    phi, gamma = _sampled(axis)
    p, i, d = gains[0], gains[1] * axis.period, gains[2] / axis.period
    closed = np.zeros((5, 5))  # two more states: the sum of the positions, and the last position
    closed[:3, :3] = phi
    closed[:3] -= gamma * np.array([p + i + d, 0, 0, i, -d])
    closed[3, [0, 3]] = closed[4, 0] = 1
    return bool(np.abs(np.linalg.eigvals(closed)).max() < 1)


def peaks(axis: Axis, gains: tuple[float, float, float]) -> tuple[float, float]:
    """Peaks of |1/(1+L)| and |L/(1+L)|; infinite for an unstable loop."""
    if not stable(axis, gains):
        return float("inf"), float("inf")
    _, response = loop(axis, gains)
    return float(np.abs(1 / (1 + response)).max()), float(np.abs(response / (1 + response)).max())


def tune(axis: Axis, seed: int = 0) -> tuple[float, float, float]:
    """Proportional, integral and rate gain with the largest integral gain within PEAK."""
    from scipy.optimize import differential_evolution  # as above

    def cost(logs: Floats) -> float:
        p, i, d = (float(v) for v in np.exp(logs))
        worst = max(peaks(axis, (p, i, d)))
        return -float(logs[1]) + 50 * max(0.0, min(worst, 1e3) - PEAK)

    span = [(np.log(0.05 * axis.inertia), np.log(80 * axis.inertia))] * 3
    found = differential_evolution(cost, span, seed=seed, maxiter=120, tol=1e-6)
    p, i, d = (float(v) for v in np.exp(found.x))
    return p, i, d
