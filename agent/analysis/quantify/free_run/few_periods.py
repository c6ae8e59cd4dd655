"""A record of few periods once more, sample by sample.

Few slips tell little of a valve: some five models explain twelve periods about as well, most of them with S
too large and the delay too short. The blocks of a long period blur what tells them apart, when PV turns after
a slip; of its samples the right one explains clearly more. So it is sought once more with a sample a block,
from the stems of the grid and from many others, and believed where it needs clearly less. Where what the
model leaves of the samples is white, nothing is left to seek
(docs/decisions/0039-few-periods-sample-by-sample.md).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.coarse_grid import COARSE, Family
from agent.analysis.quantify.free_run.elsewhere import moved_elsewhere
from agent.analysis.quantify.free_run.fitted import refine, restart
from agent.analysis.quantify.free_run.growing_horizon import best_of_populations
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.quantify.free_run.search import TO_A_BIN, Found, concluded, follow, led_by
from agent.analysis.quantify.free_run.starts import best_by_bin, climbed
from agent.analysis.quantify.free_run.stem_scan import with_best_stems
from agent.identify.fitted import by_error, start
from agent.identify.problem import FIRST_LOOK, first_periods
from agent.identify.residuals import LEAST_LAG, autocorrelation

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopHints, LoopWindow
    from agent.identify.fitted import Fitted
    from agent.identify.problem import Problem

FEW = 13
"""Periods below which a record has few (simulated loops, seeds 2000 to 2309)."""
FINE = 200.0
"""Least number of blocks in a period, so that long records take no more than twice the time of theirs."""
WHITE = 0.1
"""Autocorrelation of what is left of the samples, below which it is white (likewise): wrong ones have at
least 0.12; right ones at most 0.05, but for two, and for those whose noise is not white."""
CLEARLY_LESS = 0.95
"""Error over that of the model before, sample by sample, below which another is believed (likewise)."""


def searched_by_samples(found: Found, window: LoopWindow, problem: Problem) -> Found:
    """Return what was found, or with the model that explains the samples of few periods clearly better.

    Not where the shots decide: there the free run of the best goes wrong at a stroke, and others look better.
    """
    periods = (len(problem.op) - problem.quiet) / problem.period
    if periods >= FEW or found.by_shots_alone:
        return found
    fine = pose(window, FINE)
    if isinstance(fine, str) or fine.block == problem.block:
        return found
    rng = np.random.default_rng(0)
    begun = restart(found.best, found.best.structure)
    (told,) = refine(refine([begun], fine, 0.1, (80, 250), rng), fine, 0.03, (60, 200), rng)
    if autocorrelation(told, fine, LEAST_LAG) < WHITE:
        return found
    others = by_error(best_by_samples(fine, problem, window.hints, rng))
    if not others or others[0].error >= CLEARLY_LESS * told.error:
        return found
    return led_by(start(others[0].candidate, others[0].structure, problem), found, problem, rng)


def best_by_samples(
    fine: Problem, problem: Problem, hints: LoopHints, rng: np.random.Generator
) -> list[Fitted]:
    """Return the best model from the stems of the grid, from many others, and of populations."""
    climbs = climbed(problem, Family(hints.integrating), COARSE, rng)
    best = []
    for starts in (climbs, with_best_stems(climbs, first_periods(fine, FIRST_LOOK), rng)):
        followed, spread, _ = follow(best_by_bin(starts, fine, TO_A_BIN), fine, rng)
        found = concluded(followed, None, spread, fine, hints, rng) if followed else None
        if found is not None:
            best.append(moved_elsewhere(found.best, fine, rng))
    came = best_of_populations(fine, hints, rng)
    if came is not None:
        best.append(moved_elsewhere(came, fine, rng))
    return best
