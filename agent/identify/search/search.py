"""The search: islands from anywhere, and around what they found, in turn, until noise is left.

One schedule: an even cycle is an island (valves from anywhere climb), an odd one climbs again from valves
scattered around what was found. One criterion: what a candidate costs (``price``). One stop: the residual of
the best model is white noise, some cycles in a row gained nothing, the budget is spent, or the best valve
explains hardly more than none.
See docs/methods/population.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.fitted import start
from agent.identify.objective import FOPDT, INTEGRATOR, SIZE, SOPDT
from agent.identify.problem import first_periods
from agent.identify.residuals import autocorrelation
from agent.identify.search.anywhere import valves_from_anywhere
from agent.identify.search.children import scattered
from agent.identify.search.climb import PARENTS, climb
from agent.identify.search.population import Candidates, apart, join, least, periods_of, reach

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.arrays import IntArray
    from agent.identify.problem import Problem

STRUCTURES = (FOPDT, SOPDT, INTEGRATOR)
MANY_PERIODS = 12
"""Periods from which a record has a first part that distinguishes valves."""
FIRST_SHARE, FIRST_LEAST = 16, 6.0
"""First horizon: periods over ``FIRST_SHARE``, at least ``FIRST_LEAST``;"""
FEW_SHARE, FEW_LEAST = 0.5, 3.5
"""with few periods, half of them."""
ISLAND, MORE = 6000, 1500
"""Valves from anywhere on an island, and beside those scattered around what was found."""
AROUND, SCALE = 300, 0.02
"""Scattered ones, and how far, OP spans."""
GOES_ON = 2
"""Valves from anywhere that climb, over the parents of the first horizon."""
APART = 0.02
"""Distance of those, over the range of a coordinate."""
OF_A_BIN = 16
"""Of one niche, at most."""
FINALISTS = 24
"""Kept from cycle to cycle."""
WHITE = 0.15
"""Correlation of a residual with the one of the block before up to which it is white: of 122 simulated loops
(seeds 40000 to 40121) every valve whose S was off by more than 2 % of the span left 0.23 or more."""
GAIN = 0.98
"""Cost over that before, above which a cycle gained nothing."""
CYCLES = 10
"""At most; the budget ends a search before."""
IN_VAIN = 3
"""Cycles in a row without a gain that end a search: around what was found, an island, and around it."""
BUDGET = 35e6
"""Samples through which valves may be simulated before the last cycle: about a second of one core."""


@dataclass(frozen=True, slots=True)
class Searched:
    """What a search found."""

    finalists: Candidates
    """On the whole record, best first."""
    early: tuple[Candidates, ...]
    """Populations on the way, on parts of the record."""
    ended: str
    """``white``: the residual is white noise; ``in_vain``: further cycles gained nothing;
    ``explains_little``: hardly better than no valve; ``budget``: it is spent, and more might be found."""
    work: float
    """Samples through which valves were simulated."""


def search(
    problem: Problem,
    structures: Sequence[int] = STRUCTURES,
    worth: float = math.inf,
    seed: int = 0,
) -> Searched:
    """Return the best valves with their processes.

    Args:
        problem: The record.
        structures: Processes that are possible, at least one.
        worth: Cost below which a valve explains enough to go on after the first island, PV units squared.
        seed: Of the random numbers; the same record gives the same answer.
    """
    rng = np.random.default_rng(seed)
    possible = possible_of(structures)
    horizon = first_horizon(problem)
    part = first_periods(problem, horizon)
    finalists = Candidates(np.empty((0, SIZE)), np.empty(0, dtype=np.int64), np.empty(0))
    early: tuple[Candidates, ...] = ()
    vain, work, ended = 0, 0.0, "budget"
    for cycle in range(CYCLES):
        around = finalists if cycle % 2 else None
        begun = _begun(problem, part, around, structures, rng)
        climbed = climb(begun, problem, horizon, possible, rng, around)
        work += climbed.work + (ISLAND if around is None else MORE) * len(part.op)
        early += climbed.early
        before = least(finalists)
        finalists = join(climbed.population, finalists).sorted(FINALISTS)
        vain = vain + 1 if least(finalists) > GAIN * before else 0
        if least(finalists) > worth:
            ended = "explains_little"
        elif cycle % 2 and periods_of(problem) >= MANY_PERIODS and leaves_white(finalists, problem):
            ended = "white"
        elif vain >= IN_VAIN:
            ended = "in_vain"
        elif work <= BUDGET:
            continue
        break
    return Searched(finalists, early, ended, work)


def _begun(
    problem: Problem,
    part: Problem,
    around: Candidates | None,
    structures: Sequence[int],
    rng: np.random.Generator,
) -> Candidates:
    """Return the valves that a cycle begins with, from anywhere or also around some."""
    count, most = (ISLAND, GOES_ON * PARENTS) if around is None else (MORE, PARENTS)
    begun = valves_from_anywhere(count, problem, part, structures, rng)
    begun = begun.take(apart(begun, most, APART, OF_A_BIN, reach(problem), problem.op_span))
    if around is None:
        return begun
    return join(begun, scattered(around, AROUND, SCALE, problem, rng))


def leaves_white(finalists: Candidates, problem: Problem) -> bool:
    """Whether the residual of the best finalist, the first, has no memory of the block before."""
    structure = int(finalists.structures[0])
    return abs(autocorrelation(start(finalists.candidates[0], structure, problem), problem, 1)) <= WHITE


def possible_of(structures: Sequence[int]) -> IntArray:
    """Return 1 for each structure that is possible, else 0, (3,)."""
    return np.array([int(each in structures) for each in range(len(STRUCTURES))], dtype=np.int64)


def first_horizon(problem: Problem) -> float:
    """Return how many periods the search looks at first."""
    periods = periods_of(problem)
    if periods >= MANY_PERIODS:
        return min(periods, max(FIRST_LEAST, periods / FIRST_SHARE))
    return max(min(FEW_LEAST, periods), FEW_SHARE * periods)
