"""Genetic algorithm over the bounded space of stiction, 0 <= J <= S <= S0.

The outer search of Jelali (2008), reference ``methods.md`` 4.3. Real-coded: tournaments choose the parents,
a child lies on the line through two of them or somewhat beyond, and mutations move some children at random.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.valves.bounded_search import bands, within

if TYPE_CHECKING:
    from agent.analysis.quantify.valves.bounded_search import Objective
    from agent.analysis.record.recording import FloatArray

POPULATION = 34
ELITE = 2
"""Best points that are kept unchanged."""
MUTATED = 0.3
"""Share of the children that a mutation moves."""
SMALLEST_MUTATION = 0.005
"""Standard deviation in the last generation, share of S0; 0.2 in the first."""
BEYOND = 0.25
"""How far a child may lie outside its parents, share of their distance."""
GENERATIONS = 60
STALLED = 20
"""Generations without a better point after which the search ends."""


def genetic_search(objective: Objective, start: FloatArray, largest: float) -> FloatArray:
    """Return the best point (S, J) found, OP units, (2,).

    Half of the first population lies about ``start``, the other half anywhere; one of it is no stiction. The
    seed is fixed: one record, one answer.

    Args:
        objective: What to make small.
        start: First guess (S, J), OP units, (2,).
        largest: S0, OP units.
    """
    random = np.random.default_rng(2008)
    people = largest * random.random((POPULATION, 2))
    people[::2] = start + 0.1 * largest * random.standard_normal((POPULATION // 2, 2))
    people[0], people[1] = start, 0.0
    people = within(people, largest)
    errors = objective(bands(people))
    stalled = 0
    for generation in range(GENERATIONS):
        order = np.argsort(errors, kind="stable")
        people, errors = people[order], errors[order]
        size = largest * 0.2 * (SMALLEST_MUTATION / 0.2) ** (generation / (GENERATIONS - 1))
        children = within(_children(people, size, random), largest)
        children_errors = objective(bands(children))
        stalled = 0 if children_errors.min() < errors[0] else stalled + 1
        people = np.concatenate([people[:ELITE], children])
        errors = np.concatenate([errors[:ELITE], children_errors])
        if stalled == STALLED:
            break
    return np.asarray(people[np.argmin(errors)])


def _children(people: FloatArray, size: float, random: np.random.Generator) -> FloatArray:
    """Return the next generation without the elite; ``people`` (k, 2), OP units, the best first."""
    count = POPULATION - ELITE
    parents = people[random.integers(POPULATION, size=(2, count, 2)).min(axis=2)]  # tournaments of two
    share = random.uniform(-BEYOND, 1 + BEYOND, (count, 1))
    children = share * parents[0] + (1 - share) * parents[1]
    mutated = random.random(count) < MUTATED
    children[mutated] += size * random.standard_normal((np.count_nonzero(mutated), 2))
    return np.asarray(children)
