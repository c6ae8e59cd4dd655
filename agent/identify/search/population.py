"""A population: many candidates with their structures and what they cost, the best first or not."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray, IntArray
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    LOG_TAU,
    LOG_TAU2,
    SIZE,
    STEM_HIGH,
    STEM_LOW,
    S,
)
from agent.identify.problem import Problem
from agent.identify.search.price import price
from agent.identify.side_by_side.gauss_newton import ERROR, GIVE_UP, fit_processes, fits_for
from agent.identify.side_by_side.positions import alike, fill_positions, group_for, pass_filters
from agent.identify.slices import in_slices
from agent.jit import kernel
from agent.lanes import WIDTH
from agent.physics.valves.damped_stem import GIVE

S_BINS, STRUCTURES = 16, 3
"""Niches: bins of S over the OP span, for each structure."""
TAKEN_OVER = 4
"""Gauss-Newton steps with which a model of one view is taken over in another."""
SAME_ERROR = 1e-5
"""Relative difference of two errors below which they are of one candidate."""


class Candidates(NamedTuple):
    """Candidates, not sorted."""

    candidates: FloatArray
    """(k, SIZE)."""
    structures: IntArray
    """Of their processes, (k,)."""
    costs: FloatArray
    """Sum of squares times ``price``, PV units squared, (k,)."""

    def take(self, places: IntArray) -> Candidates:
        """Return some of them, as copies."""
        return Candidates(self.candidates[places], self.structures[places], self.costs[places])

    def sorted(self, most: int) -> Candidates:
        """Return the best, at most so many."""
        return self.take(np.argsort(self.costs, kind="stable")[:most])


def join(*populations: Candidates) -> Candidates:
    """Return one population of several."""
    return Candidates(
        np.concatenate([each.candidates for each in populations]),
        np.concatenate([each.structures for each in populations]),
        np.concatenate([each.costs for each in populations]),
    )


def reach(problem: Problem) -> FloatArray:
    """Return the range of each coordinate, in which distances are measured; 0: it does not count, (SIZE,)."""
    ranges = np.zeros(SIZE)
    ranges[[LOG_TAU, LOG_TAU2]] = problem.max_log_tau
    ranges[DELAY] = problem.max_delay
    ranges[[S, LEVEL]] = problem.op_span
    ranges[J_RATIO] = 1.0
    ranges[BRISTLES] = GIVE[1]
    ranges[LOG_DAMPING : LOG_REST + 1] = np.subtract(STEM_HIGH, STEM_LOW)
    return ranges


@kernel
def apart(
    population: Candidates, most: int, distance: float, per_niche: int, ranges: FloatArray, span: float
) -> IntArray:
    """Return the places of the best that are apart, best first.

    Args:
        population: To choose from.
        most: Number that is chosen, at most.
        distance: In one coordinate at least, over its range.
        per_niche: Most of one niche, so that a broad wrong basin leaves room for needles.
        ranges: From ``reach``.
        span: OP span, OP units.
    """
    candidates, structures, costs = population
    chosen = np.empty(most, np.int64)
    count = 0
    of_niche = np.zeros((S_BINS, STRUCTURES), np.int64)
    for i in np.argsort(costs, kind="mergesort"):
        if count == most or not np.isfinite(costs[i]):
            break
        at = min(S_BINS - 1, int(S_BINS * candidates[i, S] / span))
        room_left = of_niche[at, structures[i]] < per_niche
        if room_left and alone(i, population, chosen[:count], distance, ranges):
            chosen[count] = i
            count += 1
            of_niche[at, structures[i]] += 1
    return chosen[:count]


@kernel
def alone(i: int, population: Candidates, chosen: IntArray, distance: float, ranges: FloatArray) -> bool:
    """Whether a member differs from all that are chosen, in cost and in place."""
    candidates, structures, costs = population
    for other in chosen:
        if costs[i] <= (1.0 + SAME_ERROR) * costs[other]:
            return False
        far = structures[i] != structures[other] or candidates[i, FIRST] != candidates[other, FIRST]
        for x in range(SIZE):
            if ranges[x] > 0.0 and abs(candidates[i, x] - candidates[other, x]) > distance * ranges[x]:
                far = True
                break
        if not far:
            return False
    return True


@kernel
def counted_blocks(problem: Problem) -> float:
    """Return the number of blocks that count."""
    count = 0.0
    for t in range(problem.weight.size):
        count += problem.weight[t]
    return count


def refit(
    population: Candidates, problem: Problem, evaluations: int, first: int = 0, give_up: float = math.inf
) -> None:
    """Fit the processes of a population to a record, in place.

    Args:
        population: Its valves stay.
        problem: The record.
        evaluations: Passes over the record for each, at most.
        first: Place of the first that is fitted.
        give_up: Cost above which a fit is ended early.
    """
    in_slices(
        lambda begin, end: _refit(population, problem, evaluations, begin, end, give_up),
        first,
        len(population.costs),
    )


@kernel
def _refit(
    population: Candidates, problem: Problem, evaluations: int, begin: int, end: int, give_up: float
) -> None:
    candidates, structures, costs = population
    counted = counted_blocks(problem)
    group, fits, factors = group_for(problem), fits_for(problem), np.empty(WIDTH)
    order = alike(candidates, begin, end)
    for first in range(0, order.size, WIDTH):
        places = order[first : first + WIDTH]
        for lane in range(places.size):
            i = places[lane]
            factors[lane] = price(candidates[i], structures[i], problem, counted)
            fits.values[GIVE_UP, lane] = give_up / factors[lane]
        fill_positions(candidates, places, problem, group)
        pass_filters(problem, group)
        fit_processes(candidates, structures, places, problem, evaluations, group.passed, fits)
        for lane in range(places.size):
            costs[places[lane]] = factors[lane] * fits.values[ERROR, lane]


def taken_over(population: Candidates, problem: Problem) -> Candidates:
    """Return a population of one view of a record in another, its processes fitted there, as copies."""
    copies = population.take(np.arange(len(population.costs)))
    refit(copies, problem, TAKEN_OVER)
    return copies


def periods_of(problem: Problem) -> float:
    """Return the periods in a record, from where the loop begins to swing."""
    return float((problem.op.size - problem.quiet) / problem.period)


def least(population: Candidates) -> float:
    """Return what the best costs; infinite where there is none."""
    return float(population.costs.min()) if len(population.costs) else math.inf
