"""A climb: a population follows a record that grows as fast as its best can, then settles on all of it.

One missed slip displaces the stem until the next reversal or longer. So the basin of the true valve narrows
with every stroke: over the whole record it is a needle a quarter per cent of the span wide, over four periods
some per cent. On a few periods the population finds the basin; it keeps it while the record grows, where a
fixed growth (twice, say) loses the true valve between six and twelve periods.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.problem import first_periods
from agent.identify.search.children import generation
from agent.identify.search.population import (
    Candidates,
    apart,
    counted_blocks,
    join,
    least,
    periods_of,
    reach,
    refit,
)

if TYPE_CHECKING:
    from agent.identify.arrays import FloatArray, IntArray
    from agent.identify.problem import Problem

# Chosen on simulated loops (the trial of reference/search.md, and seeds 40000 to 40121 of random_plants).
FEWEST = 16
"""Parents at a horizon, at least; else they become fewer as the record grows, so that each costs the same."""
CHILDREN = 12
STEP, LEAST_STEP, STEP_POWER = 0.1, 0.15, 0.6
"""Largest step in S at the first horizon (OP spans), its least share later, and how it falls."""
SECOND_STEP = 0.7
"""Of the second generation at a horizon, over the first."""
GROWTH, LEAST_GROWTH = 2.0, 1.12
"""Of the record: at most, and where the best cannot follow at all."""
FASTER = 1.5
"""Growth over the one before, at most."""
FOLLOWS = 1.5
"""Mean square over the longer record over that before, up to which the best follow."""
SCOUTS = 20
"""Of the best, by which that is judged."""
TO_THE_END = 0.8
"""Share of the record from which the next one is all of it."""
NICHES = (4, 4, 2)
"""Share of the parents that one niche may have at the first, second and later horizons: 1 in so many."""
LAST_PARENTS, LAST_FEWEST, LAST_STEP = 24, 8, 0.02
"""On the whole record."""
LAST_GENERATIONS = 10
LAST_GAIN = 0.003
"""Relative gain of a generation below which its step is halved,"""
SMALLEST_STEP = 0.004
"""until it is so small, OP spans."""
MOST_HORIZONS = 30
DISTANCE = 0.1
"""Distance of parents, over the step: nearer ones have the same children."""


@dataclass(frozen=True, slots=True)
class Climbed:
    """Where a climb ended."""

    population: Candidates
    """On the whole record, best first."""
    early: tuple[Candidates, ...]
    """The parents at each horizon on the way, for the intervals."""
    work: float
    """Samples through which valves were simulated."""


def climb(
    begun: Candidates,
    problem: Problem,
    horizon: float,
    parents: int,
    possible: IntArray,
    rng: np.random.Generator,
    finalists: Candidates | None = None,
) -> Climbed:
    """Follow a population from the first ``horizon`` periods to the whole record.

    Args:
        begun: Valves from anywhere; their costs do not count.
        problem: The whole record.
        horizon: Periods of the first part.
        parents: At the first horizon.
        possible: 1 for each structure that is possible, (3,).
        rng: Where chance comes from.
        finalists: Of climbs before, on the whole record; they join at its end.
    """
    ranges, periods = reach(problem), periods_of(problem)
    first, growth, work = horizon, GROWTH, 0.0
    part = first_periods(problem, horizon if horizon < periods else math.inf)
    population, early = begun, []
    for stage in range(MOST_HORIZONS):
        refit(population, part, 4)
        shrunk = first / horizon
        count = int(max(FEWEST, parents * shrunk))
        step = STEP * max(LEAST_STEP, shrunk**STEP_POWER)
        work += len(population.costs) * len(part.op)
        for this_step, most in ((step, count), (SECOND_STEP * step, count * 3 // 4)):
            per_niche = max(3, most // NICHES[min(stage, len(NICHES) - 1)])
            population = _parents(population, most, DISTANCE * this_step, per_niche, ranges, problem)
            work += CHILDREN * len(population.costs) * len(part.op)
            population = generation(population, CHILDREN, this_step, part, possible, rng)
        population = _parents(population, count * 3 // 4, DISTANCE / 2 * step, count, ranges, problem)
        early.append(population)
        square = least(population) / counted_blocks(part)
        if len(part.pv) == len(problem.pv):
            break
        growth = min(GROWTH, FASTER * growth)
        horizon, growth, part = _longer(population, problem, horizon, growth, square)
    if finalists is not None:
        population = join(population, finalists)
    population, more = _settled(population, problem, possible, ranges, rng)
    return Climbed(population, tuple(early[:-1]), work + more)


def _parents(
    population: Candidates, most: int, distance: float, per_bin: int, ranges: FloatArray, problem: Problem
) -> Candidates:
    return population.take(apart(population, most, distance, per_bin, ranges, problem.op_span))


def _longer(
    population: Candidates, problem: Problem, horizon: float, growth: float, square: float
) -> tuple[float, float, Problem]:
    """Return the next horizon, the growth to it, and the record up to there, as far as the best follow."""
    periods = periods_of(problem)
    scouts = population.sorted(SCOUTS)
    while True:
        longer = horizon * growth
        whole = longer >= TO_THE_END * periods
        part = problem if whole else first_periods(problem, longer)
        if growth <= LEAST_GROWTH:
            break
        trial = scouts.sorted(SCOUTS)
        refit(trial, part, 2)
        if least(trial) / counted_blocks(part) <= FOLLOWS * square:
            break
        growth = max(LEAST_GROWTH, math.sqrt(growth))
    return (periods if whole else longer), growth, part


def _settled(
    population: Candidates,
    problem: Problem,
    possible: IntArray,
    ranges: FloatArray,
    rng: np.random.Generator,
) -> tuple[Candidates, float]:
    """Return the population after generations on the whole record, best first, and the work."""
    step, parents, best, work = LAST_STEP, LAST_PARENTS, least(population), 0.0
    for _ in range(LAST_GENERATIONS):
        population = _parents(population, parents, DISTANCE * step, parents, ranges, problem)
        population = generation(population, CHILDREN, step, problem, possible, rng)
        work += len(population.costs) * len(problem.op)
        gained = least(population) < (1.0 - LAST_GAIN) * best
        best = least(population)
        parents = max(LAST_FEWEST, parents * 3 // 4)
        if not gained:
            if step < SMALLEST_STEP:
                break
            step /= 2
    return _parents(population, parents, DISTANCE / 2 * step, parents, ranges, problem), work
