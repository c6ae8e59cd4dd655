"""Populations sent out where the best model leaves more than noise, whatever the searches before it found.

With the right stem and process noise is left of PV, and is forgotten at an even pace, if it is remembered at
all; of a wrong valve slips are left, at their own times, and last for as long as a process takes. All
searches from single candidates have been made by then (docs/decisions/0042-mean-positions.md).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.growing_horizon import best_of_populations
from agent.analysis.quantify.free_run.search import led_by
from agent.analysis.quantify.free_run.second_search import CLEARLY_LESS, converged
from agent.identify.residuals import LEAST_LAG, autocorrelation

if TYPE_CHECKING:
    from agent.analysis.quantify.free_run.search import Found
    from agent.analysis.record.recording import LoopHints
    from agent.identify.problem import Problem

WHITE = 0.15
"""Autocorrelation of what is left, two blocks on, below which it is white (simulated loops, seeds 2200 to
2399; with the pace it picks four of 120 right valves that have converged, and five of twelve wrong ones).
"""


def searched_by_populations(found: Found, problem: Problem, hints: LoopHints) -> Found:
    """Return what was found, or a free run that needs clearly less, than shots do as well.

    Where shots decide, a free run that errs at a stroke less is no better. But one that follows the whole
    record with less error than stems that are set off has found the valve.
    """
    if leaves_noise(found, problem) and converged(found, problem):
        return found
    rng = np.random.default_rng(0)
    best = best_of_populations(problem, hints, rng)
    if best is None or best.error >= CLEARLY_LESS * min(found.by_shots, found.least_error):
        return found
    return led_by(best, found, problem, rng)


def leaves_noise(found: Found, problem: Problem) -> bool:
    """Return whether what the best model leaves is white, or forgotten as a first-order noise is.

    The autocorrelation of that four blocks on is the square of that two blocks on.
    """
    two, four = (autocorrelation(found.best, problem, times * LEAST_LAG) for times in (1, 2))
    return two < WHITE or four <= two**2
