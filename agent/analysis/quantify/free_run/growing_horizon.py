"""Valves of any kind, followed from the first part of a record to all of it by an evolution strategy.

The free run of a valve that slides in small jumps is a needle: a stop too early or too late moves all that
follows, and by shots, which forgive that, wrong valves need little too. Over the first eighth of the record
few stops can be wrong and the needle is wide. What is left of a population there is followed into it as the
record grows, where climbs from single candidates are caught on the way
(docs/decisions/0040-a-population-over-a-growing-record.md).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.evolution import Generation, Population, Ways, evolved
from agent.analysis.quantify.free_run.fitted import STEP, axes_of, refine
from agent.analysis.quantify.free_run.scatter import SPREADS, scattered
from agent.analysis.quantify.free_run.search import structures
from agent.identify.fitted import Fitted, by_error
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    FOPDT,
    INTEGRATOR,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    LOG_SUPPLY,
    LOG_TAU,
    LOG_TAU2,
    SIZE,
    SOPDT,
    STEM_HIGH,
    STEM_LOW,
    S,
)
from agent.identify.problem import first_periods
from agent.physics.valves.damped_stem import GIVE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray, LoopHints
    from agent.identify.problem import Problem

ISLANDS = 3
"""Populations that begin anywhere and know nothing of each other: one in three comes near the valve."""
AGAIN = 2
"""Times that all together begin again around what is left; each by itself does so once before."""
AROUND = 1500
"""Valves that a population around others begins with."""
LEAST_PERIODS = 4.0
"""Of the first part: fewer tell valves of twelve periods hardly apart."""
VALVES = 8000
"""That a population from anywhere begins with."""
PARTS: tuple[tuple[float, tuple[Generation, ...]], ...] = (
    (1 / 8, (Generation(0.1, 150, 20),)),
    (1 / 4, (Generation(0.08, 80, 20), Generation(0.05, 80, 20))),
    (1 / 2, (Generation(0.05, 50, 20), Generation(0.03, 50, 20))),
)
"""Of the record, and the generations there; the workbench's search goes by the same plan."""
WHOLE = (
    *(Generation(0.04, 40, 15),) * 2,
    *(Generation(0.03, 30, 20),) * 2,
    *(Generation(0.02, 20, 20),) * 2,
    Generation(0.015, 12, 30),
    Generation(0.01, 8, 40),
)
CROSSED = (0.0, 0.5)
"""Share of children that are crossed, in each population of a structure."""
LAST_CROSSED = 0.3
KEPT = 60
"""Of a population from one part to the next."""
FINALISTS = 3
LEAST_S = 0.01
"""OP spans, of the valves that are looked at."""
LEAST_J_RATIO = 0.01
"""Logarithms of half of them are spread: hardly any jump is as common as much of one."""
LEAST_TAU = 0.7
"""Samples."""
VALVE = (S, J_RATIO, LEVEL, LOG_DAMPING, LOG_SUPPLY, LOG_REST, BRISTLES)


def best_of_populations(problem: Problem, hints: LoopHints, rng: np.random.Generator) -> Fitted | None:
    """Return the best by free run that populations from all over the range of valves come to, if any."""
    ways = ways_of(problem)
    begun = [from_anywhere(problem, hints, ways, rng) for _ in range(ISLANDS)]
    people = over_the_whole([from_around(each, problem, ways, rng) for each in begun], problem, ways, rng)
    for _ in range(AGAIN):
        people = from_around(people, problem, ways, rng)
    best = by_error(refine(fits_of(people)[:FINALISTS], problem, 0.1, (80, 250), rng))
    return best[0] if best else None


def from_anywhere(problem: Problem, hints: LoopHints, ways: Ways, rng: np.random.Generator) -> Population:
    """Return what populations from all over the range of valves come to."""
    begun = [
        (population(random_valves(problem, rng), structure), crossed)
        for structure in structures(hints)
        for crossed in CROSSED
    ]
    return over_the_whole(
        [over_parts(people, crossed, problem, ways, rng) for people, crossed in begun], problem, ways, rng
    )


def from_around(people: Population, problem: Problem, ways: Ways, rng: np.random.Generator) -> Population:
    """Return what populations come to that begin around those that are left, each with another stem.

    The stem with which a valve came through decides where its needle ends; over the first part others are
    tried on nearly the same valve.
    """
    followed, left = [people], fits_of(people)
    for structure in np.unique(people.structures):
        parents = [each for each in left if each.structure == structure]
        for crossed in CROSSED:
            chosen = rng.integers(0, len(parents), AROUND)
            near = [scattered(parents[i], SPREADS[i % len(SPREADS)], problem, rng) for i in chosen]
            valves = np.array([each.candidate for each in near])
            valves[:, BRISTLES] = random_bristles(len(valves), rng)
            followed.append(over_parts(population(valves, int(structure)), crossed, problem, ways, rng))
    return over_the_whole(followed, problem, ways, rng)


def over_parts(
    people: Population, crossed: float, problem: Problem, ways: Ways, rng: np.random.Generator
) -> Population:
    """Return what is left of a population over the parts of the record, one after the other."""
    periods = (problem.op.size - problem.quiet) / problem.period
    for part, generations in PARTS:
        first = first_periods(problem, max(part * periods, LEAST_PERIODS))
        people = evolved(people, np.array(generations), crossed, KEPT, ways, first, rng)
    return people


def over_the_whole(
    populations: Sequence[Population], problem: Problem, ways: Ways, rng: np.random.Generator
) -> Population:
    """Return what is left of some populations together over the whole record."""
    together = Population(*(np.concatenate(each) for each in zip(*populations, strict=True)))
    return evolved(together, np.array(WHOLE), LAST_CROSSED, KEPT, ways, problem, rng)


def fits_of(people: Population) -> list[Fitted]:
    """Return the candidates of a population with their structures and errors, in their order."""
    return [
        Fitted(float(error), int(structure), candidate)
        for candidate, structure, error in zip(*people, strict=True)
    ]


def ways_of(problem: Problem) -> Ways:
    """Return where a population may go on a record."""
    ranges = np.zeros(SIZE)
    ranges[[LOG_TAU, LOG_TAU2]] = problem.max_log_tau
    ranges[DELAY] = 0.0 if problem.fixed_delay > 0 else problem.max_delay
    ranges[[S, LEVEL]] = problem.op_span
    ranges[J_RATIO] = 1.0
    ranges[BRISTLES] = GIVE[1]
    ranges[LOG_DAMPING : LOG_REST + 1] = np.subtract(STEM_HIGH, STEM_LOW)
    step = STEP.copy()
    step[DELAY] = 3.0
    of_process = axes_of(FOPDT, problem), axes_of(SOPDT, problem), axes_of(INTEGRATOR, problem)
    return Ways(of_process, np.array(VALVE), ranges, step)


def population(candidates: FloatArray, structure: int) -> Population:
    """Return candidates (k, SIZE) that are yet to be evaluated."""
    count = len(candidates)
    return Population(candidates, np.full(count, structure), np.full(count, math.inf))


def random_valves(problem: Problem, rng: np.random.Generator, count: int = VALVES) -> FloatArray:
    """Return candidates from all over their range, (count, SIZE).

    S, and J/S, evenly in half of them, in the other half their logarithms.
    """
    found = np.zeros((count, SIZE))
    found[:, S] = half_in_logarithms(LEAST_S, count, rng) * problem.op_span
    found[:, J_RATIO] = rng.permutation(half_in_logarithms(LEAST_J_RATIO, count, rng))
    found[:, LEVEL] = problem.op.min() + problem.op_span * rng.random(count)
    found[:, FIRST] = rng.choice((-1.0, 1.0), count)
    found[:, LOG_DAMPING : LOG_REST + 1] = rng.uniform(STEM_LOW, STEM_HIGH, (count, 3))
    found[:, BRISTLES] = random_bristles(count, rng)
    found[:, DELAY] = problem.fixed_delay or 1.0 + (problem.max_delay - 1.0) * rng.random(count) ** 2
    found[:, LOG_TAU] = rng.uniform(math.log(LEAST_TAU), problem.max_log_tau, count)
    found[:, LOG_TAU2] = np.minimum(found[:, LOG_TAU], rng.uniform(-1.0, problem.max_log_tau - 1.0, count))
    return found


def half_in_logarithms(least: float, count: int, rng: np.random.Generator) -> FloatArray:
    """Return numbers from ``least`` to 1, (count,): evenly in the first half, by logarithms in the other."""
    spread = rng.random(count)
    return np.where(np.arange(count) < count // 2, least + (1.0 - least) * spread, least ** (1.0 - spread))


def random_bristles(count: int, rng: np.random.Generator) -> FloatArray:
    """Return what the bristles of valves give, (count,): half of them are stiff."""
    low, high = np.log(GIVE)
    return np.asarray(np.exp(rng.uniform(low, high, count)) * (rng.random(count) < 0.5))
