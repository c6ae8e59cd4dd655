"""Points followed from the first part of a record to all of it, by an evolution strategy.

The error of a sticking valve over a whole record is a needle: one slip too early or too late moves what
follows. Over its first part few slips can be wrong, and the valley is wide; what is left of the population
there is followed into the needle as the part grows. A simplex, which goes on from one point, is caught by
every step of the error on the way. Sources: H.-P. Schwefel, Evolution and Optimum Seeking (1995), the
(mu + lambda) strategy; R. Storn and K. Price, J. Global Optimization 11 (1997) 341, differences of points.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.workbench.projection import target_of
from agent.workbench.search import Objective, objective_of, whitened

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.search import Whitened


SMALLEST = 1.5
"""Decades from the largest standard deviation of a mutation to the smallest."""
MUTATED = 3
"""Coordinates, at most."""
APART = 0.15
"""Least distance of two parents in any coordinate, over the generation's step."""
SAME = 1e-5
"""Part by which errors differ at least: of values that mean nothing there are many."""


class Generation(NamedTuple):
    """One step of the strategy."""

    step: float
    """Largest standard deviation of a mutation, part of a coordinate's range."""
    parents: int
    children: int
    """Of each."""


PARTS: tuple[tuple[float, tuple[Generation, ...]], ...] = (
    (1 / 8, (Generation(0.1, 150, 20),)),
    (1 / 4, (Generation(0.08, 80, 20), Generation(0.05, 80, 20))),
    (1 / 2, (Generation(0.05, 50, 20), Generation(0.03, 50, 20))),
)
"""Parts of the record, and the generations there."""
WHOLE = (
    *(Generation(0.04, 40, 15),) * 2,
    *(Generation(0.03, 30, 20),) * 2,
    *(Generation(0.02, 20, 20),) * 2,
    Generation(0.015, 12, 30),
    Generation(0.01, 8, 40),
)
KEPT = 60
"""Of a population from one part to the next."""
LAST_CROSSED = 0.3
CROSSED = (0.0, 0.5, 0.0, 0.5)
"""Share of children that take a difference of two others, in each population. It leads along valleys, and a
population that has it crowds into one of them sooner."""


def followed(objective: Whitened, points: FloatArray, at: FloatArray) -> FloatArray:
    """Return the best points of the unit cube, best first, (m, k), that differ in error. Always the same.

    Args:
        objective: Over the whole record.
        points: To begin from over its first part, (p, k).
        at: One that is also tried over each part, (k,).
    """
    random = np.random.default_rng(0)
    populations = [at[None, :]]
    for i, crossed in enumerate(CROSSED):
        people = points[i :: len(CROSSED)]
        for part, generations in PARTS:
            begun = np.vstack((at, people))
            people = _evolved(over_first(objective, part), begun, generations, crossed, random)
        populations.append(people)
    return _evolved(objective, np.vstack(populations), WHOLE, LAST_CROSSED, random)


def over_first(objective: Whitened, part: float) -> Whitened:
    """Return the same over the first samples, that hold ``part`` of those that count."""
    counted = np.cumsum(objective.target.weight)
    samples = int(np.searchsorted(counted, part * counted[-1])) + 1
    record = objective.record
    first = replace(record, op=record.op[:samples], pv=record.pv[:samples], weight=record.weight[:samples])
    target = target_of(first, first.weight, linear=True)
    return whitened(objective_of(objective.model, first, target), objective.noise)


def _evolved(
    objective: Objective,
    people: FloatArray,
    generations: Sequence[Generation],
    crossed: float,
    random: np.random.Generator,
) -> FloatArray:
    """Return those that are left of ``people`` (p, k) and of their children, best first."""
    errors = np.array([objective.error(each) for each in people])
    for each in generations:
        chosen = _apart(people, errors, each.parents, APART * each.step)
        people, errors = people[chosen], errors[chosen]
        children = _children(people, each, crossed, random)
        errors = np.concatenate((errors, [objective.error(child) for child in children]))
        people = np.vstack((people, children))
    return people[_apart(people, errors, KEPT, APART * generations[-1].step)]


def _apart(people: FloatArray, errors: FloatArray, most: int, distance: float) -> list[int]:
    """Return which are the best of ``people`` (p, k) that differ from all better ones, best first."""
    chosen: list[int] = []
    for i in np.argsort(errors, kind="stable").tolist():
        if len(chosen) == most:
            break
        far = np.abs(people[chosen] - people[i]).max(axis=1, initial=0.0) > distance
        if bool(np.all(far & (errors[i] > (1 + SAME) * errors[chosen]))):
            chosen.append(i)
    return chosen


def _children(
    parents: FloatArray, generation: Generation, crossed: float, random: np.random.Generator
) -> FloatArray:
    """Return the children of ``parents`` (p, k)."""
    children = np.repeat(parents, generation.children, axis=0)
    count, size = children.shape
    one, other = parents[random.integers(len(parents), size=(2, count))]
    taken = random.random((count, size)) < random.choice((0.3, 0.6), (count, 1))
    taken &= random.random((count, 1)) < crossed
    children += taken * random.choice((0.5, 1.0), (count, 1)) * (one - other)
    mutated = _some(random, count, size)
    deviation = generation.step * 10.0 ** -random.uniform(0.0, SMALLEST, (count, 1))
    children += mutated * deviation * random.standard_normal((count, size))
    return np.clip(children, 0.0, 1.0)


def _some(random: np.random.Generator, count: int, size: int) -> NDArray[np.bool_]:
    """Return one to ``MUTATED`` coordinates of each, (count, size)."""
    order = random.random((count, size)).argsort(axis=1)
    return np.asarray(order < random.integers(1, MUTATED + 1, (count, 1)), dtype=np.bool_)
