"""The proofs: what is proved of which module, and why the other modules with control have none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

Mode = Literal["prove", "bmc", "cover"]


@dataclass(frozen=True)
class Proof:
    """One run of the prover on one module with given parameters.

    Attributes:
        name: of the proof, unique.
        top: the module, with every module that it uses.
        mode: `prove` is k-induction: the assertions hold for ever. `bmc` examines only the first `depth` clocks after
            power-up. `cover` shows that every cover point can be reached in `depth` clocks.
        depth: clocks; of `prove`, the length of the induction.
        parameters: of `top`.
        rules: files of `properties/` bound to the design, besides the reset's.
        assumed: assertions of `top` about its user, which are assumed instead of proved. They are proved, or tested in
            simulation, where the module is used.
        reset: clocks for which the reset is held, at power-up and later; 0: the module has no reset.
        quick: part of the quick selection.
        engine: of SymbiYosys.
        config: configuration whose package is read.
        blackboxes: modules whose outputs may be anything.
    """

    name: str
    top: str
    mode: Mode
    depth: int
    parameters: Mapping[str, int] = field(default_factory=dict)
    rules: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    reset: int = 1
    quick: bool = True
    engine: str = "smtbmc yices"
    config: str = "tiny"
    blackboxes: tuple[str, ...] = ()


PROOFS: tuple[Proof, ...] = (
    Proof("fifo", "slog_fifo", "prove", 3, {"Width": 2, "Depth": 4}, rules=("fifo",)),
    Proof("fifo_odd", "slog_fifo", "prove", 3, {"Width": 2, "Depth": 3}, rules=("fifo",)),
    Proof("fifo_one", "slog_fifo", "prove", 3, {"Width": 2, "Depth": 1}, rules=("fifo",)),
    Proof("fifo_kept", "slog_fifo", "prove", 3, {"Width": 2, "Depth": 4, "Kept": 1}, rules=("fifo",),
          assumed=("SlogFifoKept",)),
    Proof("fifo_covers", "slog_fifo", "cover", 12, {"Width": 2, "Depth": 4}, rules=("fifo",)),
    Proof("stage", "slog_stage", "prove", 3, {"Width": 2}, rules=("stage",)),
    Proof("stage_half", "slog_stage", "prove", 3, {"Width": 2, "Half": 1}, rules=("stage",)),
)
