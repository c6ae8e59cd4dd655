"""An evolution strategy over valves, each with the process that fits the way it takes.

A simplex and random steps go on from one candidate and are caught by every step of the error; a population
goes on from all that are good and apart. Parents compete with their children, so that nothing good is lost.
Sources: H.-P. Schwefel, Evolution and Optimum Seeking (1995), the (mu + lambda) strategy; R. Storn and
K. Price, J. Global Optimization 11 (1997) 341, differences of points.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.quantify.free_run.local_search import simplex
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    J_RATIO,
    LEAST_LOG_TAU,
    LEVEL,
    LOG_DAMPING,
    LOG_TAU,
    LOG_TAU2,
    STEM_HIGH,
    STEM_LOW,
    S,
    free_run_error,
    valve_position,
)
from agent.identify.problem import Problem
from agent.jit import kernel
from agent.physics.valves.damped_stem import GIVE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray

SMALLEST = 1.5
"""Decades from the largest standard deviation of a mutation to the smallest."""
MUTATED = 3
"""Coordinates, at most."""
APART = 0.15
"""Least distance of two parents in any coordinate, over the generation's step."""
SAME = 1e-5
"""Part by which errors differ at least: of values that mean nothing there are many."""
PROCESS_EVALUATIONS = (30, 12)
"""For the process of a parent, and of a child: what is left to search is the valve."""
PROCESS_STEP = (4.0, 2.0)
"""First steps in it, over the generation's step."""
LEAST_S = 0.002
"""OP spans, as in every random step."""


class Generation(NamedTuple):
    """One step of the strategy."""

    step: float
    """Largest standard deviation of a mutation, part of a coordinate's range."""
    parents: int
    children: int
    """Of each."""


class Ways(NamedTuple):
    """Along which coordinates a population may go, and how far."""

    of_process: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]
    """Those of the process that are searched, by structure."""
    of_valve: NDArray[np.int64]
    ranges: FloatArray
    """Of each coordinate, 0: it is not searched, (SIZE,)."""
    process_step: FloatArray
    """First steps in a process, (SIZE,)."""


class Population(NamedTuple):
    """Candidates with their processes and errors."""

    candidates: FloatArray
    """(k, SIZE)"""
    structures: NDArray[np.int64]
    """(k,)"""
    errors: FloatArray
    """Of the free run, PV units squared, (k,)."""


@kernel
def evolved(
    begun: Population,
    generations: FloatArray,
    crossed: float,
    kept: int,
    ways: Ways,
    problem: Problem,
    rng: np.random.Generator,
) -> Population:
    """Return those that are left of a population and of their children, best first.

    Args:
        begun: Their errors are computed here.
        generations: A ``Generation`` a row, (g, 3).
        crossed: Share of children that take a difference of two parents. It leads along valleys, and a
            population that has it crowds into one of them sooner.
        kept: At most so many are returned.
        ways: Where they may go.
        problem: The record.
        rng: Of mutations.
    """
    people = begun
    for i in range(people.errors.size):
        people.errors[i] = free_run_error(people.candidates[i], people.structures[i], problem)
    for g in range(len(generations)):
        step, most, children = generations[g, 0], int(generations[g, 1]), int(generations[g, 2])
        chosen = apart(people, most, APART * step, ways.ranges)
        k, size = chosen.size, people.candidates.shape[1]
        total = k * (children + 1)
        following = Population(np.empty((total, size)), np.empty(total, np.int64), np.empty(total))
        for i in range(k):
            structure = people.structures[chosen[i]]
            following.structures[i] = structure
            following.candidates[i], following.errors[i] = with_process(
                people.candidates[chosen[i]], structure, 0, step, ways, problem
            )
        parents = following.candidates[:k]
        for child in range(k, total):
            parent = (child - k) % k
            structure = following.structures[parent]
            candidate = mutated(parents, parent, structure, step, crossed, ways, problem, rng)
            following.structures[child] = structure
            following.candidates[child], following.errors[child] = with_process(
                candidate, structure, 1, step, ways, problem
            )
        people = following
    chosen = apart(people, kept, APART * generations[-1, 0], ways.ranges)
    return Population(people.candidates[chosen], people.structures[chosen], people.errors[chosen])


@kernel
def apart(people: Population, most: int, distance: float, ranges: FloatArray) -> NDArray[np.int64]:
    """Return which are the best that differ from all better ones, best first; ``distance`` over the range."""
    chosen = np.empty(most, np.int64)
    count = 0
    for i in np.argsort(people.errors):
        if count == most or not np.isfinite(people.errors[i]):
            break
        if stands_apart(people, i, chosen[:count], distance, ranges):
            chosen[count] = i
            count += 1
    return chosen[:count]


@kernel
def stands_apart(
    people: Population, i: int, chosen: NDArray[np.int64], distance: float, ranges: FloatArray
) -> bool:
    """Whether a candidate differs in error and in some coordinate from all that were chosen."""
    for other in chosen:
        if people.errors[i] <= (1.0 + SAME) * people.errors[other]:
            return False
        far = people.structures[i] != people.structures[other]
        far = far or people.candidates[i, FIRST] != people.candidates[other, FIRST]
        for axis in range(ranges.size):
            off = abs(people.candidates[i, axis] - people.candidates[other, axis])
            far = far or (ranges[axis] > 0.0 and off > distance * ranges[axis])
        if not far:
            return False
    return True


@kernel
def with_process(
    candidate: FloatArray, structure: int, rank: int, step: float, ways: Ways, problem: Problem
) -> tuple[FloatArray, float]:
    """Return the candidate with the process that fits the way of its valve, and its error."""
    axes = ways.of_process[structure]
    if axes.size == 0:
        return candidate, free_run_error(candidate, structure, problem)
    return simplex(
        candidate,
        PROCESS_STEP[rank] * step * ways.process_step,
        axes,
        valve_position(candidate, problem),
        structure,
        problem,
        PROCESS_EVALUATIONS[rank],
    )


@kernel
def mutated(
    parents: FloatArray,
    parent: int,
    structure: int,
    step: float,
    crossed: float,
    ways: Ways,
    problem: Problem,
    rng: np.random.Generator,
) -> FloatArray:
    """Return a child: some coordinates moved; J, delay and first slip go along with S at times."""
    child: FloatArray = parents[parent].copy()
    axes = np.concatenate((ways.of_process[structure], ways.of_valve))
    if rng.random() < crossed:
        one, other = rng.integers(0, len(parents)), rng.integers(0, len(parents))
        share = 0.3 if rng.random() < 0.5 else 0.6
        factor = 0.5 if rng.random() < 0.5 else 1.0
        for axis in axes:
            if rng.random() < share:
                child[axis] += factor * (parents[one, axis] - parents[other, axis])
    deviation = step * 10.0 ** (-SMALLEST * rng.random())
    for _ in range(rng.integers(1, MUTATED + 1)):
        axis = axes[rng.integers(0, axes.size)]
        moved = deviation * ways.ranges[axis] * rng.standard_normal()
        if axis == J_RATIO:
            moved *= problem.op_span / max(child[S], 0.02 * problem.op_span)
        child[axis] += moved
        if axis == S:
            follow_s(child, child[S] - moved, problem, rng)
    within_bounds(child, problem)
    return child


@kernel
def follow_s(child: FloatArray, before: float, problem: Problem, rng: np.random.Generator) -> None:
    """Let J stay in every other step of S, let the middle of the band, and let the delay make up for it."""
    child[S] = max(child[S], LEAST_S * problem.op_span)
    more = child[S] - before
    if rng.random() < 0.5:
        child[J_RATIO] *= before / child[S]
    if rng.random() < 0.5:
        child[LEVEL] += 0.5 * child[FIRST] * more
    if problem.fixed_delay == 0.0 and rng.random() < 0.5:
        child[DELAY] -= more / problem.op_speed


@kernel
def within_bounds(child: FloatArray, problem: Problem) -> None:
    """Put each coordinate at the nearest place that it may have."""
    child[S] = min(max(child[S], LEAST_S * problem.op_span), problem.op_span)
    child[J_RATIO] = min(max(child[J_RATIO], 0.0), 1.0)
    if problem.fixed_delay == 0.0:
        child[DELAY] = min(max(child[DELAY], 1.0), problem.max_delay)
    child[LOG_TAU] = min(max(child[LOG_TAU], LEAST_LOG_TAU), problem.max_log_tau)
    child[LOG_TAU2] = min(max(child[LOG_TAU2], LEAST_LOG_TAU), child[LOG_TAU])
    for i in range(3):
        child[LOG_DAMPING + i] = min(max(child[LOG_DAMPING + i], STEM_LOW[i]), STEM_HIGH[i])
    child[BRISTLES] = min(child[BRISTLES], GIVE[1]) if child[BRISTLES] >= GIVE[0] else 0.0
