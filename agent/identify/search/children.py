"""A child of a population: a valve a little off one of its parents, and a generation of them."""

from __future__ import annotations

import math

import numpy as np

from agent.identify.arrays import FloatArray, IntArray
from agent.identify.bounds import keep_in_bounds
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    FOPDT,
    INTEGRATOR,
    J_RATIO,
    LEAST_LOG_TAU,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    LOG_TAU,
    LOG_TAU2,
    SIZE,
    SOPDT,
    STEM_HIGH,
    STEM_LOW,
    S,
)
from agent.identify.problem import Problem
from agent.identify.search.anywhere import draw_stem, drawn_bristles
from agent.identify.search.bristles import exchange_bristles, move_bristles
from agent.identify.search.population import Candidates, refit
from agent.jit import kernel

CROSSED = 0.4
"""Share of the children that take the difference of two parents: it has the scale and the ridges of the
population (differential evolution, Storn and Price, J. Global Optimization 11 (1997) 341)."""
OTHER_STRUCTURE = 0.06
"""Share of the children with another structure, so that one population serves all."""
DECADES = 1.5
"""Steps are up to so many powers of ten smaller than the largest."""
J_STEP, STEM_STEP, REST_STEP, GIVE_STEP = 1.5, 3.0, 6.0, 6.0
"""Steps of J, stem, rest at the same strokes, and bristles, over that of S: as much moves a slip alike."""
LEAST_S = 0.005
"""Smallest S of a child, over the OP span."""
HOPELESS = 0.8
"""Share of the parents that are better than a child that is given up."""
EVALUATIONS = 3
"""Passes over the record for a child's process, at most: more cost more than more children bring."""
MOVES = 9
"""Kinds of a step."""


def generation(
    parents: Candidates,
    children: int,
    step: float,
    problem: Problem,
    possible: IntArray,
    rng: np.random.Generator,
) -> Candidates:
    """Return the parents, as they are, and their children, each with its process fitted.

    Args:
        parents: Fitted to this record.
        children: Of each.
        step: Largest step in S, OP spans.
        problem: The record.
        possible: 1 for each structure that is possible, else 0, (3,).
        rng: Where chance comes from.
    """
    k = len(parents.costs)
    if k == 0:  # nothing fits a record whose hints contradict it
        return parents
    grown = brood(parents, children, step, problem, possible, rng)
    give_up = float(np.sort(parents.costs)[min(k - 1, int(HOPELESS * k))])
    refit(grown, problem, EVALUATIONS, k, give_up)
    return grown


@kernel
def brood(
    parents: Candidates,
    children: int,
    step: float,
    problem: Problem,
    possible: IntArray,
    rng: np.random.Generator,
) -> Candidates:
    """Return the parents, as they are, and their children, whose processes are not yet fitted."""
    k = len(parents.candidates)
    total = k * (1 + children)
    candidates = np.empty((total, SIZE))
    structures = np.empty(total, np.int64)
    costs = np.full(total, np.inf)
    candidates[:k], structures[:k], costs[:k] = parents.candidates, parents.structures, parents.costs
    for i in range(k, total):
        parent = (i - k) % k
        candidates[i] = candidates[parent]
        structures[i] = structures[parent]
        move_valve(candidates[i], parents.candidates, step, problem, rng)
        if rng.random() < OTHER_STRUCTURE:
            structures[i] = other_structure(candidates[i], structures[i], problem, possible, rng)
        keep_in_bounds(candidates[i], problem)
    return Candidates(candidates, structures, costs)


@kernel
def move_valve(
    candidate: FloatArray, parents: FloatArray, step: float, problem: Problem, rng: np.random.Generator
) -> None:
    """Move the valve of a candidate in place, and its delay along: S and delay trade off."""
    span = problem.op_span
    s_before = candidate[S]
    bands = np.array([candidate[S], candidate[S] * candidate[J_RATIO]])  # S and J, OP units
    if rng.random() < CROSSED and len(parents) > 3:
        cross(candidate, bands, parents, rng)
        moves = int(rng.random() < 0.5)
    else:
        moves = 1 + int(3.0 * rng.random())
    deviation = step * 10.0 ** (-DECADES * rng.random())
    for _ in range(moves):
        take_step(candidate, bands, deviation, problem, rng)
    s = min(max(bands[0], LEAST_S * span), span)
    candidate[S], candidate[J_RATIO] = s, min(max(bands[1] / s, 0.0), 1.0)
    if s != s_before:
        follow(candidate, s - s_before, problem, rng)


@kernel
def cross(candidate: FloatArray, bands: FloatArray, parents: FloatArray, rng: np.random.Generator) -> None:
    """Add part of the difference of two parents to some coordinates."""
    one = parents[int(len(parents) * rng.random())]
    other = parents[int(len(parents) * rng.random())]
    share = (0.5 if rng.random() < 0.5 else 1.0) * (0.3 if rng.random() < 0.3 else 1.0)
    often = 0.3 if rng.random() < 0.5 else 0.7
    if rng.random() < often:
        bands[0] += share * (one[S] - other[S])
    if rng.random() < often:
        bands[1] += share * (one[S] * one[J_RATIO] - other[S] * other[J_RATIO])
    for x in (LEVEL, LOG_DAMPING, LOG_DAMPING + 1, LOG_REST, BRISTLES):
        if rng.random() < often:
            candidate[x] += share * (one[x] - other[x])


@kernel
def take_step(
    candidate: FloatArray, bands: FloatArray, deviation: float, problem: Problem, rng: np.random.Generator
) -> None:
    """Move one coordinate, or two that belong together; ``bands`` are S and J, OP units."""
    kind, span = int(MOVES * rng.random()), problem.op_span
    z = deviation * rng.standard_normal()
    if kind == 0:
        bands[0] += z * span
    elif kind == 1:
        before = max(bands[0], 1e-9)
        bands[0] += z * span
        bands[1] *= bands[0] / before
    elif kind == 2:
        bands[1] += J_STEP * z * span
    elif kind == 3:
        candidate[LEVEL] += z * span
    elif kind < 7:
        axis = kind - 4
        candidate[LOG_DAMPING + axis] += STEM_STEP * z * (STEM_HIGH[axis] - STEM_LOW[axis])
    elif kind == 7:
        move_rest(candidate, bands, REST_STEP * z)
    else:
        move_bristles(candidate, bands, GIVE_STEP * z, problem.op_speed, rng)


@kernel
def move_rest(candidate: FloatArray, bands: FloatArray, z: float) -> None:
    """Move the force at rest while what a reversal (S + rest J) and a step ((1 - rest) J) need stay."""
    before = math.exp(candidate[LOG_REST])
    reversal, stair = bands[0] + before * bands[1], (1.0 - before) * bands[1]
    moved = candidate[LOG_REST] + z * (STEM_HIGH[2] - STEM_LOW[2])
    candidate[LOG_REST] = min(max(moved, STEM_LOW[2]), STEM_HIGH[2])
    now = math.exp(candidate[LOG_REST])
    bands[1] = stair / (1.0 - now)
    bands[0] = reversal - now * bands[1]


@kernel
def follow(candidate: FloatArray, by: float, problem: Problem, rng: np.random.Generator) -> None:
    """Move level and delay along with S, which has moved ``by`` OP units: a later slip needs less delay."""
    if rng.random() < 0.5:
        candidate[LEVEL] += 0.5 * candidate[FIRST] * by
    if problem.fixed_delay == 0.0:
        candidate[DELAY] = max(1.0, candidate[DELAY] - rng.random() * by / problem.op_speed)


@kernel
def other_structure(
    candidate: FloatArray, structure: int, problem: Problem, possible: IntArray, rng: np.random.Generator
) -> int:
    """Return a structure near the candidate's, with time constants and delay to match, or the same."""
    to = FOPDT
    if structure == INTEGRATOR:
        to = FOPDT if possible[FOPDT] == 1 else SOPDT
    elif candidate[LOG_TAU] > math.log(problem.period) and rng.random() < 0.5:
        to = INTEGRATOR
    elif structure == FOPDT:
        to = SOPDT
    if possible[to] == 0:
        return structure
    if structure == INTEGRATOR:
        candidate[LOG_TAU] = min(problem.max_log_tau, math.log(2.0 * problem.period))
    if to == SOPDT:
        candidate[LOG_TAU2] = max(LEAST_LOG_TAU, candidate[LOG_TAU] - 0.5 - 1.5 * rng.random())
        candidate[DELAY] = max(1.0, candidate[DELAY] - 0.7 * math.exp(candidate[LOG_TAU2]))
    elif structure == SOPDT:
        candidate[DELAY] += 0.7 * math.exp(candidate[LOG_TAU2])
    return to


@kernel
def scattered(
    around: Candidates, count: int, scale: float, problem: Problem, rng: np.random.Generator
) -> Candidates:
    """Return valves around some, the best first among them: S and J somewhat off, most with another stem.

    Args:
        around: Best first.
        count: How many.
        scale: Of S, OP spans; half to twice that.
        problem: The record.
        rng: Where chance comes from.
    """
    candidates = np.empty((count, SIZE))
    structures = np.empty(count, np.int64)
    least = LEAST_S * problem.op_span
    for i in range(count):
        k = int(len(around.candidates) * rng.random() ** 2)
        candidate = candidates[i]
        candidate[:] = around.candidates[k]
        structures[i] = around.structures[k]
        width = scale * 2.0 ** (int(3.0 * rng.random()) - 1) * problem.op_span
        before = candidate[S]
        bands = np.array([before, before * candidate[J_RATIO]])
        bands[1] += J_STEP * width * rng.standard_normal()
        bands[0] = min(problem.op_span, max(least, before + width * rng.standard_normal()))
        follow(candidate, bands[0] - before, problem, rng)
        if rng.random() < 0.7:
            draw_stem(candidate, rng)
            if rng.random() < 0.5:
                give = 0.0 if rng.random() < 0.5 else drawn_bristles(rng)
                exchange_bristles(candidate, bands, give, problem.op_speed)
        candidate[S] = max(bands[0], least)
        candidate[J_RATIO] = bands[1] / candidate[S]
        keep_in_bounds(candidate, problem)
    return Candidates(candidates, structures, np.zeros(count))
