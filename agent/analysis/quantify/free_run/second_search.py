"""Searching once more where the first search has not converged.

The right valve explains the whole record about as well as a few of its periods, hardly needs stems that are
set off, and leaves noise. Where the best one does not, it is sought again, on grids that the first search did
not see: one family of processes at a time, for a wrong valve with two poles may crowd out the right one with
one; with more values of J, for a valve that slides in small jumps fits at its own J only; at last with other
stems, for one that stops a sample late is lost whatever its S; and every valve of
the grid is compared by shots, for over five periods already the free run of a valve that is nearly right may
look worse than that of a wrong one. What needs the least by shots is kept, and believed where it needs
clearly less than what the first search found (docs/decisions/0026-second-search.md,
0028-residuals-that-last.md, 0031-further-searches-bounded.md, 0037-around-the-best.md).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.quantify.free_run.coarse_grid import Family, Grid
from agent.analysis.quantify.free_run.fitted import refine, restart
from agent.analysis.quantify.free_run.scatter import searched_around
from agent.analysis.quantify.free_run.search import structures, surer
from agent.analysis.quantify.free_run.shooting import Shots
from agent.analysis.quantify.free_run.shooting_search import Stage, compared, shot
from agent.analysis.quantify.free_run.starts import OTHER_STEMS, STEMS, climbed
from agent.identify.fitted import by_error
from agent.identify.objective import FOPDT, INTEGRATOR, SOPDT
from agent.identify.problem import first_periods
from agent.identify.residuals import lasting

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.quantify.free_run.search import Found
    from agent.analysis.record.recording import FloatArray, LoopHints
    from agent.identify.fitted import Fitted
    from agent.identify.problem import Problem

JUMPS = np.array([0, 0.02, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14, 0.17, 0.2, 0.25, 0.3, 0.4, 0.6, 0.8, 0.97])


class Start(NamedTuple):
    """Where a search starts from."""

    grid: Grid
    stems: FloatArray
    """Damping, supply and rest of each, (k, 3)."""


FINER = Grid(8.0, 56, JUMPS, (6, 6, 4), 2)
STARTS = (
    Start(FINER, STEMS),
    Start(Grid(5.0, 67, JUMPS, (6, 6, 4), 2), STEMS),
    Start(FINER, OTHER_STEMS),
)
"""Of the second search, the third and the fourth, which is the last."""
FAMILIES = {FOPDT: Family(False, False), SOPDT: Family(False, True), INTEGRATOR: Family(True, False)}
OF_A_FAMILY = Stage(5, Shots(0.5, 4.0), 0.5, 5, 40)
SURE_OF_A_FAMILY = 6
"""That go on from each family, whatever the others have."""
OF_ALL = 40
"""That go on, of all families."""
STAGES = (
    Stage(5, Shots(0.5, 4.0), 0.4, 100, 15),
    Stage(12, Shots(0.5, 4.0), 0.4, 60, 6),
    Stage(math.inf, Shots(0.5, 4.0), 0.4, 80, 3),
    Stage(math.inf, Shots(0.5, 10.0), 0.3, 200, 3),
)
AROUND = 5
"""Searches around what each of these found, at most."""
IN_VAIN = 2
"""Of them in a row after which no more follow."""
GAINS = 0.9
"""Error of shots over that before, below which a search was not in vain."""
FEW_PERIODS = 8
WORSE = 1.25
"""Mean square over the whole record, over that of the same model fitted to a few periods, of what has not
converged."""
NEEDS_SHOTS = 0.9
"""Error of shots over that of the free run, below which neither has."""
LASTS = 0.15
"""Autocorrelation of the residuals an eighth of a period on, from which they are more than noise."""
CLEARLY_LESS = 0.8
"""Error over that of the first search below which a further one is believed: a tenth less is gained on
wrong hills too. From 0.75 to 0.85 as good (simulated loops, seeds 2000 to 2199)."""


def converged_search(found: Found, problem: Problem, hints: LoopHints) -> Found:
    """Return what further searches found until one converged, or what was found where that is hardly less."""
    first = found
    for number, begin in enumerate(STARTS):
        rng = np.random.default_rng(1 + number)
        if done(found, number, problem):
            break
        found = searched_again(found, begin, problem, hints, rng)
        in_vain = 0
        for _ in range(AROUND):
            if in_vain == IN_VAIN or done(found, number, problem):
                break
            before, found = found.by_shots, searched_around(found, problem, hints, rng)
            in_vain = 0 if found.by_shots < GAINS * before else in_vain + 1
    return found if clearly_less(found, first) else first


def clearly_less(found: Found, first: Found) -> bool:
    """Return whether what was found needs clearly less than what was found first, by shots or by free run."""
    of_shots = found.by_shots < CLEARLY_LESS * first.by_shots
    return of_shots or found.least_error < CLEARLY_LESS * first.least_error


def done(found: Found, number: int, problem: Problem) -> bool:
    """Return whether nothing is left to seek.

    Residuals that last ask for one further search, no more: correlated noise and bristles last as well.
    """
    leaves_noise = number > 0 or lasting(found.best, problem) < LASTS
    return leaves_noise and converged(found, problem)


def converged(found: Found, problem: Problem) -> bool:
    """Return whether the best model explains the record as well as its first periods, and by itself."""
    best, few = found.best, first_periods(problem, FEW_PERIODS)
    rng = np.random.default_rng(0)
    (fitted,) = refine([restart(best, best.structure)], few, 0.3, (30, 60), rng)
    usual = fitted.error / few.weight.sum()
    holds = best.error / problem.weight.sum() < WORSE * usual
    return bool(holds and found.by_shots > NEEDS_SHOTS * best.error)


def searched_again(
    found: Found, begin: Start, problem: Problem, hints: LoopHints, rng: np.random.Generator
) -> Found:
    """Return what a search that starts there finds, where it needs less by shots than what was found."""
    starts = [
        compared(
            climbed(problem, FAMILIES[structure], begin.grid, rng, begin.stems), OF_A_FAMILY, problem, rng
        )
        for structure in structures(hints)
    ]
    surest, free = shot(going_on(starts), found.best, STAGES, problem, rng)
    return surer(found, surest, free, problem, hints, rng)


def going_on(families: Sequence[Sequence[Fitted]]) -> list[Fitted]:
    """Return the best of all families, some of each among them; each family has its best first."""
    sure = [fitted for family in families for fitted in family[:SURE_OF_A_FAMILY]]
    others = by_error([fitted for family in families for fitted in family[SURE_OF_A_FAMILY:]])
    return sure + others[: OF_ALL - len(sure)]
