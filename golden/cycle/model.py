# SPDX-License-Identifier: Apache-2.0
"""The contract of a cycle model, and how one runs without a simulator."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from typing import Any, Protocol

Inputs = dict[str, int]
"""Input values of one clock, by port name."""
Values = dict[str, int | None]
"""Values of one clock by port name; None where the model leaves them undefined."""
Outputs = Mapping[str, Any]
"""The same values as a stimulus receives them, which checks for itself what is defined."""
Stimulus = Generator[Inputs, Outputs, None]
"""Yields the inputs of a clock and receives the outputs sampled in that clock."""


class CycleModel(Protocol):
    """A module's behaviour clock by clock: INPUTS and OUTPUTS name its ports."""

    @property
    def INPUTS(self) -> tuple[str, ...]: ...

    @property
    def OUTPUTS(self) -> tuple[str, ...]: ...

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""


def run_model(model: CycleModel, stimulus: Stimulus, observe: Callable[[Inputs, Outputs], None] | None = None) -> int:
    """Run `stimulus` against `model` alone; `observe` receives the inputs and outputs of each clock.

    Returns:
        The number of clocks.
    """
    clocks = 0
    try:
        i = next(stimulus)
        while True:
            out = model.step(i)
            clocks += 1
            if observe:
                observe(i, out)
            i = stimulus.send(out)
    except StopIteration:
        return clocks
