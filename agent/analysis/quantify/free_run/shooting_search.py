"""The search by shots: from the candidates of the first periods to valves that need few shots set off.

The free run of a candidate that is nearly right looks no better than that of a wrong one, once a stem has
stopped a sample early. Its shots do. So candidates of all bins are compared by shots, first over some
periods, and a stem that is set off gets dearer while they become fewer.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.quantify.free_run.fitted import STEP, searched
from agent.analysis.quantify.free_run.problem import first_periods
from agent.analysis.quantify.free_run.random_shots import random_shots
from agent.analysis.quantify.free_run.shooting import Shots

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.quantify.free_run.fitted import Fitted
    from agent.analysis.quantify.free_run.problem import Problem
    from agent.analysis.recording import FloatArray


class Stage(NamedTuple):
    """One comparison."""

    periods: float
    """Of the record; infinite: all."""
    shots: Shots
    scale: float
    """Of the random steps."""
    evaluations: int
    kept: int


STAGES = (
    Stage(12, Shots(0.5, 4.0), 0.5, 40, 8),
    Stage(math.inf, Shots(0.5, 4.0), 0.4, 80, 3),
    Stage(math.inf, Shots(0.5, 10.0), 0.3, 200, 3),
)
LAST = Stage(math.inf, Shots(1.0, 30.0), 0.15, 100, 3)
"""From there the free run is near."""
STARTS = 40
JOINS = 2
"""Stage that the best of the other search joins."""


class Shot(NamedTuple):
    """A candidate and its error of shots, PV units squared, of the last stage but one."""

    error: float
    structure: int
    candidate: FloatArray


def shot(
    starts: Sequence[Fitted], other: Fitted, problem: Problem, rng: np.random.Generator
) -> tuple[Shot | None, list[Shot]]:
    """Return the best by shots, and those that may fit the free run; ``other`` is the best by free run."""
    found = [Shot(f.error, f.structure, f.candidate) for f in starts[:STARTS]]
    for number, stage in enumerate(STAGES):
        if number == JOINS:
            found.append(Shot(other.error, other.structure, other.candidate))
        found = compared(found, stage, problem, rng)
    return (found[0] if found else None), compared(found, LAST, problem, rng)


def compared(shots: Sequence[Shot], stage: Stage, problem: Problem, rng: np.random.Generator) -> list[Shot]:
    """Return the best of a stage, best first."""
    part = problem if math.isinf(stage.periods) else first_periods(problem, stage.periods)
    lowered = []
    for each in shots:
        candidate, error = random_shots(
            each.candidate,
            stage.scale,
            STEP,
            np.array(searched(each.structure, problem), dtype=np.int64),
            each.structure,
            part,
            stage.shots,
            stage.evaluations,
            rng,
        )
        if math.isfinite(error):
            lowered.append(Shot(float(error), each.structure, candidate))
    return sorted(lowered, key=lambda each: each.error)[: stage.kept]
