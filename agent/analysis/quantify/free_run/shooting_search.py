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
from agent.analysis.quantify.free_run.random_shots import random_shots
from agent.analysis.quantify.free_run.shooting import Shots
from agent.identify.fitted import Fitted, by_error
from agent.identify.problem import first_periods

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.problem import Problem


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


def shot(
    starts: Sequence[Fitted],
    other: Fitted,
    stages: Sequence[Stage],
    problem: Problem,
    rng: np.random.Generator,
) -> tuple[Fitted | None, list[Fitted]]:
    """Return the best by shots, and those that may fit the free run.

    ``other`` is the best that was found otherwise; it joins the last stage.
    """
    found = list(starts)
    for stage in stages[:-1]:
        found = compared(found, stage, problem, rng)
    found = compared([*found, other], stages[-1], problem, rng)
    return (found[0] if found else None), compared(found, LAST, problem, rng)


def compared(
    fits: Sequence[Fitted], stage: Stage, problem: Problem, rng: np.random.Generator
) -> list[Fitted]:
    """Return the best of a stage with their errors of shots, best first."""
    part = first_periods(problem, stage.periods)
    lowered = []
    for each in fits:
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
        lowered.append(Fitted(float(error), each.structure, candidate))
    return by_error(lowered)[: stage.kept]
