"""A whole session in one value: its staircase, where the newest model fails, what was tried, the verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.candidates import verdict_of
from agent.workbench.comparison import Comparison, not_testable
from agent.workbench.residual.power import smallest_reduction
from agent.workbench.session.views import floor

if TYPE_CHECKING:
    from agent.workbench.session.bench import Bench


def compared(bench: Bench) -> Comparison:
    """Return the staircase of a session, and the verdict on its newest model."""
    if bench.reason is not None:
        return not_testable(bench.window.loop, bench.reason)
    tried = bench.trials.all_on(bench.step, bench.library)
    fails, spectrum = bench.where_it_fails(), bench.lines()
    candidates, losses = tried.decision.candidates, bench.step.held_out.losses
    rng = np.random.default_rng(0)
    smallest = None
    if candidates:
        best = tried.models[candidates[0].effect].held_out.losses
        smallest = smallest_reduction(losses, best, len(candidates), rng)
    return Comparison(
        loop=bench.window.loop,
        steps=bench.staircase(),
        where_it_fails=fails,
        lines=() if spectrum is None else spectrum.from_outside,
        candidates=candidates,
        verdict=verdict_of(bench.step, tried, fails, spectrum, bench.record.facts),
        noise_floor=floor(bench.step, bench.trials, rng),
        smallest_percent=smallest,
        reason=None,
    )
