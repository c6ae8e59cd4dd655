"""The best model at each S and at each J: what else explains the record, for profile and intervals.

An archive of elites (Mouret and Clune, arXiv 1504.04909, 2015): each cell of S, and each of J, keeps the best
model that was met in it, and has children in turn. So the least cost at each S is found over all else, basins
that the search left on its way among them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.objective import J_RATIO, S
from agent.identify.search.children import generation
from agent.identify.search.population import Candidates, join, least, taken_over

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.arrays import FloatArray, IntArray
    from agent.identify.problem import Problem
    from agent.identify.search.cycle import Searched

S_CELL, J_CELL = 1 / 100, 1 / 25
"""Cells, OP spans. Twice as many have half of the children each, and their best are found less often."""
OF_EACH_HORIZON = 12
"""Cells of S that each horizon of the search gives, its best first."""
ROUNDS = tuple(0.06 * 6.0 ** (-k / 23) for k in range(24))
"""Largest steps of the rounds of children, OP spans. With three rounds the best model at the true S was often
not found, and intervals did not reach it (simulated loops, seeds 67000 to 67029)."""
FEW_ROUNDS = ROUNDS[::8]
"""Where a valve explains little: nobody needs the interval of its S."""
GAIN = 0.002
"""Share by which the best of a cell becomes better where it gains: a nat or two of a thousand samples;"""
IN_VAIN = 3
"""rounds in a row without a cell that gains end it: intervals hold as often with three of four rounds, less
often with half of them (seeds 67000 to 67029)."""
CHILDREN, BROOD = 6, 200
"""Of each parent and of all, at least: where a record allows one valve only, a few children do not find how
its numbers move together (seeds 98800 to 98819 and six loops with hidden valves, some 70 nats worse)."""
WORTH = 1.3
"""Cost over the least above which a model is no parent: above what a record cannot distinguish."""


def met_by(searched: Searched, problem: Problem) -> Candidates:
    """Return the best models that a search has met in some cells, on parts of the record among them."""
    early = [_of_cells(each, problem).sorted(OF_EACH_HORIZON) for each in searched.early]
    return join(searched.finalists, *early)


def elites_of(
    met: Candidates, problem: Problem, possible: IntArray, rounds: Sequence[float] = ROUNDS
) -> Candidates:
    """Return the best model of each cell of S and of J, best first.

    Args:
        met: Models to begin with, in whichever view they were met.
        problem: The record.
        possible: 1 for each structure that is possible, (3,).
        rounds: Largest step of each round of children, OP spans.
    """
    rng = np.random.default_rng(1)
    archive = taken_over(met, problem)
    vain = 0
    before_round: dict[float, float] = {}
    for step in rounds:
        archive = _of_cells(archive, problem)
        parents = archive.take(np.flatnonzero(archive.costs <= WORTH * least(archive)))
        best = _cells_of_s(parents, problem)
        vain = 0 if _gains(best, before_round) else vain + 1
        if vain == IN_VAIN:
            break
        before_round = best
        children = max(CHILDREN, BROOD // max(1, len(parents.costs)))
        archive = join(archive, generation(parents, children, step, problem, possible, rng))
    archive = _of_cells(archive, problem)
    return archive.sorted(len(archive.costs))


def _cells_of_s(population: Candidates, problem: Problem) -> dict[float, float]:
    """Return what the best of each cell of S costs."""
    places = population.candidates[:, S] / problem.op_span / S_CELL
    best = _best_of(places, population.costs)
    return dict(zip(np.floor(places[best]).tolist(), population.costs[best].tolist(), strict=True))


def _gains(now: dict[float, float], before: dict[float, float]) -> bool:
    """Whether in any cell the best costs less than before, or is the first."""
    return any(cost < (1.0 - GAIN) * before.get(place, math.inf) for place, cost in now.items())


def _of_cells(population: Candidates, problem: Problem) -> Candidates:
    """Return the best of each cell of S and the best of each cell of J."""
    span = problem.op_span
    s = population.candidates[:, S] / span
    j = s * population.candidates[:, J_RATIO]
    of_s, of_j = _best_of(s / S_CELL, population.costs), _best_of(j / J_CELL, population.costs)
    return population.take(np.union1d(of_s, of_j))


def _best_of(places: FloatArray, costs: FloatArray) -> IntArray:
    """Return the place of the least cost in each cell."""
    order = np.argsort(costs, kind="stable")
    _, first = np.unique(np.floor(places[order]).astype(np.int64), return_index=True)
    return order[first]
