"""From the best model to a better one beside it, where the look around the best met one.

The last random steps are small and end in the nearest of many dents. The look around the best, made for the
intervals, starts from further away and at times ends lower: then that is the best, and is looked around in
turn (docs/decisions/0037-around-the-best.md).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.fitted import refine
from agent.analysis.quantify.free_run.search import led_by

if TYPE_CHECKING:
    from agent.analysis.quantify.free_run.search import Found
    from agent.identify.fitted import Fitted
    from agent.identify.problem import Problem

BETTER = 0.98
"""Error over that of the best model, from which a model beside it is better."""
MOVES = 5
"""At most."""


def moved_on(found: Found, problem: Problem) -> Found:
    """Return what was found, or what is found by moving on to better models beside the best.

    Not where the shots decide: what fits the free run better there errs at a stroke less, not in the valve.
    """
    rng = np.random.default_rng(0)
    for _ in range(MOVES):
        beside = better_beside(found)
        if beside is None:
            break
        (best,) = refine(refine([beside], problem, 0.1, (60, 250), rng), problem, 0.03, (60, 400), rng)
        found = led_by(best, found, problem, rng)
    return found


def better_beside(found: Found) -> Fitted | None:
    """Return the best of the models with the same process that explain the record clearly better, or None."""
    if found.by_shots_alone:
        return None
    better = [f for f in found.others if f.structure == found.best.structure]
    better = [f for f in better if f.error < BETTER * found.best.error]
    return better[0] if better else None
