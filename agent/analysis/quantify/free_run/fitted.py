"""A candidate with its structure and error, and how it is improved by the two local searches."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.local_search import refine_each, simplex
from agent.identify.fitted import Fitted
from agent.identify.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    LOG_TAU,
    LOG_TAU2,
    SOPDT,
    free_run_errors,
    valve_position,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.identify.problem import Problem

SEARCHED = {FOPDT: (LOG_TAU, DELAY), SOPDT: (LOG_TAU, DELAY, LOG_TAU2), INTEGRATOR: (DELAY,)}
STEP = np.array([0.5, 1.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
"""First steps in a process, for each coordinate of a candidate."""


def searched(structure: int, problem: Problem) -> list[int]:
    """Return the coordinates of the process that are searched."""
    return not_given(SEARCHED[structure], problem)


def axes_of(structure: int, problem: Problem) -> NDArray[np.int64]:
    """Return the same as a kernel takes them, also where there are none."""
    return np.array(searched(structure, problem), dtype=np.int64)


def not_given(axes: Sequence[int], problem: Problem) -> list[int]:
    """Return the coordinates without the delay where the user gave it."""
    return [axis for axis in axes if not (axis == DELAY and problem.fixed_delay > 0)]


def restart(fitted: Fitted, structure: int) -> Fitted:
    """Return a candidate that is yet to be fitted, with a structure that may be another."""
    candidate = fitted.candidate.copy()
    candidate[LOG_TAU2] = min(candidate[LOG_TAU2], candidate[LOG_TAU])
    return Fitted(math.inf, structure, candidate)


def evaluated(candidates: Sequence[FloatArray], structure: int, problem: Problem) -> list[Fitted]:
    """Evaluate many candidates as they stand."""
    if not candidates:
        return []
    errors = free_run_errors(np.array(candidates), structure, problem)
    return [Fitted(float(e), structure, c) for e, c in zip(errors, candidates, strict=True)]


def smooth(fitted: Fitted, problem: Problem, scale: float, evaluations: int) -> Fitted:
    """Improve delay and time constants."""
    axes = searched(fitted.structure, problem)
    if not axes:
        return fitted
    candidate, error = simplex(
        fitted.candidate,
        STEP * scale,
        np.array(axes),
        valve_position(fitted.candidate, problem),
        fitted.structure,
        problem,
        evaluations,
    )
    return Fitted(float(error), fitted.structure, candidate)


def refine(
    fits: Sequence[Fitted],
    problem: Problem,
    scale: float,
    evaluations: tuple[int, int],
    rng: np.random.Generator,
) -> list[Fitted]:
    """Improve of each the process, then the valve with the process following; ``evaluations`` for each."""
    if not fits:
        return []
    structures = [fitted.structure for fitted in fits]
    candidates, errors = refine_each(
        np.array([fitted.candidate for fitted in fits]),
        np.array(structures),
        (axes_of(FOPDT, problem), axes_of(SOPDT, problem), axes_of(INTEGRATOR, problem)),
        STEP * scale,
        scale,
        problem,
        evaluations,
        rng,
    )
    return [Fitted(float(e), s, c) for e, s, c in zip(errors, structures, candidates, strict=True)]
