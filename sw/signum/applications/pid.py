# SPDX-License-Identifier: Apache-2.0
"""A PID controller with limits on its output and on how fast the output changes, for one axis."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Gains:
    """Output per unit of error, of its integral and of its rate; limits of the output and of its change per second.

    The defaults turn a position error in metres into a velocity in m/s for a vehicle whose velocity follows its command
    with a lag of 0.4 s. They cancel that lag: rate gain = lag x proportional gain leaves a first-order loop, whose gain
    is set for a bandwidth of half a hertz, a tenth of a frame rate of 5 Hz; the integral, of a time of one second,
    removes the error that the current leaves.
    """

    proportional: float = 3.0
    integral: float = 3.0
    rate: float = 1.2
    limit: float = 0.4
    slew: float = 0.8


@dataclass
class Pid:
    """The controller of one axis. The integral is frozen while the output is at its limit."""

    gains: Gains = Gains()
    output: float = 0.0
    _sum: float = 0.0
    _last: float | None = field(default=None, repr=False)

    def step(self, error: float, dt: float, rate: float | None = None, learn: bool = True) -> float:
        """The next output for an error (wanted minus measured), `dt` seconds after the call before.

        Args:
            rate: of the error; None to compute it from the errors, which is wrong for a clipped error.
            learn: False freezes the integral.
        """
        g = self.gains
        if rate is None:
            rate = 0.0 if self._last is None else (error - self._last) / dt
        self._last = error
        integral = self._sum + error * dt if learn else self._sum
        wanted = g.proportional * error + g.integral * integral + g.rate * rate
        if abs(wanted) <= g.limit:
            self._sum = integral
        wanted = min(max(wanted, -g.limit), g.limit)
        change = min(max(wanted - self.output, -g.slew * dt), g.slew * dt)
        self.output += change
        return self.output

    def hold(self) -> float:
        """The output without a measurement: that of the integral, which balances the current."""
        g = self.gains
        self._last = None
        self.output = min(max(g.integral * self._sum, -g.limit), g.limit)
        return self.output
