"""The best model at each S and at each J: what else explains the record, for profile and intervals.

An archive of elites (Mouret and Clune, arXiv 1504.04909, 2015): each cell of S, and each of J, keeps the best
model that was met in it, and has children in turn. So the least cost at each S is found over all else, basins
that the search left on its way among them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.identify.objective import J_RATIO, S
from agent.identify.search.children import generation
from agent.identify.search.population import Candidates, join, least, refit

if TYPE_CHECKING:
    from agent.identify.arrays import FloatArray, IntArray
    from agent.identify.problem import Problem
    from agent.identify.search.cycle import Searched

S_CELL, J_CELL = 1 / 200, 1 / 50
"""Cells, OP spans: a third of the margins of the intervals, so that their ends are not the cells'."""
OF_EACH_HORIZON = 12
"""Cells of S that each horizon of the search gives, its best first."""
ROUNDS = (0.04, 0.02, 0.01)
"""Largest steps of the rounds of children, OP spans."""
CHILDREN = 6
WORTH = 3.0
"""Cost over the least above which a model is no parent: far above what counts as alike."""


def elites_of(searched: Searched, problem: Problem, possible: IntArray) -> Candidates:
    """Return the best model of each cell of S and of J, best first.

    Args:
        searched: What the search found.
        problem: The record.
        possible: 1 for each structure that is possible, (3,).
    """
    rng = np.random.default_rng(1)
    early = [_of_cells(each, problem).sorted(OF_EACH_HORIZON) for each in searched.early]
    archive = searched.finalists
    if early:
        before = join(*early)
        refit(before, problem, 4)
        archive = join(archive, before)
    for step in ROUNDS:
        archive = _of_cells(archive, problem)
        parents = archive.take(np.flatnonzero(archive.costs <= WORTH * least(archive)))
        archive = join(archive, generation(parents, CHILDREN, step, problem, possible, rng))
    archive = _of_cells(archive, problem)
    return archive.sorted(len(archive.costs))


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
