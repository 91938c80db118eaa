"""The contract of a cycle model, and how one runs without a simulator."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from typing import Any, Protocol

Inputs = dict[str, int]


Outputs = Mapping[str, Any]
"""Values by port name; None where the model leaves them undefined."""


Stimulus = Generator[Inputs, Outputs, None]



class CycleModel(Protocol):
    """`step` returns the outputs of a clock from state and inputs, then takes the clock edge. None = undefined."""

    @property
    def INPUTS(self) -> tuple[str, ...]: ...

    @property
    def OUTPUTS(self) -> tuple[str, ...]: ...

    def step(self, i: Inputs) -> dict[str, int | None]: ...



def run_model(model: CycleModel, stimulus: Stimulus, observe: Callable[[Inputs, Outputs], None] | None = None) -> int:
    """Run `stimulus` against `model` alone; returns the number of clocks."""
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
