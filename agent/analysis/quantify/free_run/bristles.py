"""A stem of bristles in place of the stiff one that was found, where it explains the record better.

Bristles loosen a stem while the force rises, so that it breaks away below f_S. A stiff stem takes the lower
force for its f_S, and S and J come out too small by what is loosened: at most 4 J give^2, nothing for a valve
that slides. In the search itself one more number costs more valves than it finds, so it is tried at the end,
from the valve that was found; S, J and level start where the stem breaks away at the force it did
(docs/decisions/0035-bristles.md).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.fitted import refine, restart
from agent.analysis.quantify.free_run.search import Found, Horizon, led_by
from agent.analysis.quantify.free_run.starts import STEMS
from agent.identify.fitted import Fitted, by_error, start
from agent.identify.objective import (
    BRISTLES,
    FIRST,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    RIGID,
    S,
)
from agent.identify.problem import first_periods

if TYPE_CHECKING:
    from agent.identify.problem import Problem

JUMPS = 0.3
"""J/S from which bristles move S by more than noise does."""
GIVES = (0.03, 0.06, 0.1, 0.17, 0.28)
"""What bristles give at the start."""
STEPS = (1.0, 1.7, 2.5)
"""Steps of OP at break-away that their loosening is reckoned for, over its mean step."""
HORIZONS = (
    Horizon(8, 0.25, (30, 110), 3),
    Horizon(20, 0.2, (30, 140), 2),
    Horizon(math.inf, 0.15, (30, 250), 1),
)


def with_bristles(found: Found, problem: Problem) -> Found:
    """Return what was found, or with the best stem of bristles where that explains PV better.

    Not where the shots decide: a free run that goes wrong at a stroke is mended by any new freedom.
    """
    if found.best.candidate[J_RATIO] < JUMPS or found.by_shots_alone:
        return found
    rng = np.random.default_rng(0)
    fits = [fit for give in GIVES for fit in fitted_from(found.best, give, problem, rng)]
    if not fits or by_error(fits)[0].error >= found.least_error:
        return found
    return led_by(by_error(fits)[0], found, problem, rng)


def fitted_from(stiff: Fitted, give: float, problem: Problem, rng: np.random.Generator) -> list[Fitted]:
    """Return the best stem that starts with these bristles, or none.

    By itself: over few periods those that give little would crowd out the others.
    """
    fits = [bristly(stiff, give, steps, problem) for steps in STEPS]
    for horizon in HORIZONS:
        part = first_periods(problem, horizon.periods)
        begun = [restart(each, each.structure) for each in fits]
        fits = by_error(refine(begun, part, horizon.scale, horizon.evaluations, rng))[: horizon.kept]
    for scale in (0.1, 0.03):
        fits = refine(fits, problem, scale, (60, 400), rng)
    return fits


def bristly(stiff: Fitted, give: float, steps: float, problem: Problem) -> Fitted:
    """Return a candidate with bristles that breaks away at about the force at which the stiff one does."""
    candidate = stiff.candidate.copy()
    s, j = candidate[S], candidate[S] * candidate[J_RATIO]
    left = min(steps * problem.op_speed, 8.0 * j * give**2)
    loosened = min(3.0 * np.cbrt(j * (give * left) ** 2) - left, j)
    candidate[S], candidate[J_RATIO] = s + loosened, (j + loosened) / (s + loosened)
    candidate[LEVEL] += candidate[FIRST] * loosened
    candidate[BRISTLES] = give
    if candidate[LOG_REST] <= RIGID:
        candidate[LOG_DAMPING : LOG_DAMPING + 3] = np.log(STEMS[1])
    return start(candidate, stiff.structure, problem)
