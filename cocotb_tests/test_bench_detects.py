# SPDX-License-Identifier: Apache-2.0
"""The test benches themselves: a dozen mutants of two modules, chosen by the run's seed, must fail the modules' tests.

A build holds all listed mutants of a module and costs more than running them, hence several of few modules:
`make mutate SAMPLE=30` draws more of the same, and `make mutate` runs the whole list.
"""

from sim.mutate import flow, plan, reasons
from sim.seeds import session_rng


def test_sampled_mutants_are_found() -> None:
    chosen = plan.sample(plan.QUICK, 2 * plan.EACH, session_rng("mutants"))
    outcomes, broken = flow.run(chosen, jobs=1)
    assert len(chosen) >= 2 and len(outcomes) == 2 * plan.EACH
    assert not broken and not flow.judge(chosen, outcomes, reasons.load())
