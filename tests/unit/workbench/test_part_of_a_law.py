"""An effect that is little beside those of the model is suggested: no law is quite that of the plant."""

from dataclasses import replace

import numpy as np
import pytest
from loops import made

from agent.physics.bases import Fopdt
from agent.physics.effects import EFFECTS
from agent.physics.effects.load_step import LoadStepEffect
from agent.workbench.checks.lacking import OF_A_LAW
from agent.workbench.evidence import criterion_of
from agent.workbench.hooks import silent
from agent.workbench.session import Workbench
from agent.workbench.session.opening import opened
from agent.workbench.step import step_of


@pytest.fixture(scope="module")
def stepped():
    """A loop with one step of its load."""
    window = made(noise=0.05)
    return replace(window, pv=window.pv + 1.5 * (np.arange(len(window)) > 430))


@pytest.mark.parametrize(
    ("times", "kind", "lacks"), [(0, "confirmed", ()), (5, "confirmed", ()), (20, "suggested", (OF_A_LAW,))]
)
def test_a_twentieth_of_what_acts_on_op_is_suggested(stepped, times, kind, lacks):
    trials, alone = opened(stepped, Fopdt(), map, silent)
    base = step_of(alone, trials.record, None)
    found = trials.judged_on(base, [LoadStepEffect()]).models["load_step"]
    of_laws = times * criterion_of(base, found, trials.record)
    decision = trials.judged_on(replace(base, of_laws=of_laws), [LoadStepEffect()]).decision
    assert (decision.kind, decision.lacks) == (kind, lacks)


def test_a_step_counts_what_acts_on_op_and_no_load(stepped):
    bench = Workbench(stepped, without={each.name for each in EFFECTS} - {"load_step", "deadband"})
    assert bench.step.of_laws == bench.add("load_step").of_laws == 0.0
    assert bench.add("deadband").of_laws == criterion_of(bench.staircase()[1], bench.step, bench.record)
