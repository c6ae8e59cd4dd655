"""A simplex for delay and time constants, which move the error smoothly.

Where both time constants are alike, or one vanishes, a Gauss-Newton step does not see the way; a simplex
does.
"""

from __future__ import annotations

import numpy as np

from agent.identify.arrays import FloatArray, IntArray
from agent.identify.fitted import Fitted
from agent.identify.free_run_error import process_error
from agent.identify.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    LOG_TAU,
    LOG_TAU2,
    SOPDT,
    valve_position,
)
from agent.identify.problem import Problem
from agent.jit import kernel

AXES = {FOPDT: (LOG_TAU, DELAY), SOPDT: (LOG_TAU, DELAY, LOG_TAU2), INTEGRATOR: (DELAY,)}
"""Coordinates of a process that are searched."""
STEP = np.array([0.5, 1.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
"""First steps, for each coordinate of a candidate."""
ROUNDS = (0.5, 0.2)
"""Scales of the first steps of a polish, one after the other."""
EVALUATIONS = 150


def not_given(axes: tuple[int, ...], problem: Problem) -> list[int]:
    """Return the coordinates without the delay where the user gave it."""
    return [axis for axis in axes if not (axis == DELAY and problem.fixed_delay > 0)]


def polished(fitted: Fitted, problem: Problem) -> Fitted:
    """Return a candidate with its process at a minimum of the error; the valve stays."""
    axes = not_given(AXES[fitted.structure], problem)
    if not axes:
        return fitted
    position = valve_position(fitted.candidate, problem)
    candidate, error = fitted.candidate, fitted.error
    for scale in ROUNDS:
        candidate, error = simplex(
            candidate, scale * STEP, np.array(axes), position, fitted.structure, problem, EVALUATIONS
        )
    return Fitted(float(error), fitted.structure, candidate)


@kernel
def simplex(
    start: FloatArray,
    step: FloatArray,
    axes: IntArray,
    position: FloatArray,
    structure: int,
    problem: Problem,
    evaluations: int,
) -> tuple[FloatArray, float]:
    """Return the best candidate over the coordinates ``axes`` and its error (Nelder and Mead 1965).

    The coordinates are of the process: its valve stays at ``position``, OP units, (n,).
    """
    k = axes.size
    points = np.empty((k + 1, start.size))
    errors = np.empty(k + 1)
    for i in range(k + 1):
        points[i] = start
        if i > 0:
            points[i, axes[i - 1]] += step[axes[i - 1]]
        errors[i] = process_error(position, points[i], structure, problem)
        if i > 0 and not np.isfinite(errors[i]):
            points[i, axes[i - 1]] -= 2.0 * step[axes[i - 1]]
            errors[i] = process_error(position, points[i], structure, problem)
    used = k + 1
    while used < evaluations:
        order = np.argsort(errors)
        points = points[order]
        errors = errors[order]
        if errors[k] - errors[0] < 1e-7 * errors[0]:
            break
        centre = np.zeros(start.size)
        for i in range(k):
            centre += points[i] / k
        reflected = 2.0 * centre - points[k]
        e_reflected = process_error(position, reflected, structure, problem)
        used += 1
        if e_reflected < errors[0]:
            expanded = 3.0 * centre - 2.0 * points[k]
            e_expanded = process_error(position, expanded, structure, problem)
            used += 1
            if e_expanded < e_reflected:
                points[k], errors[k] = expanded, e_expanded
            else:
                points[k], errors[k] = reflected, e_reflected
        elif e_reflected < errors[k - 1]:
            points[k], errors[k] = reflected, e_reflected
        else:
            toward = reflected if e_reflected < errors[k] else points[k]
            contracted = 0.5 * (centre + toward)
            e_contracted = process_error(position, contracted, structure, problem)
            used += 1
            if e_contracted < min(e_reflected, errors[k]):
                points[k], errors[k] = contracted, e_contracted
            else:
                for i in range(1, k + 1):
                    points[i] = 0.5 * (points[0] + points[i])
                    errors[i] = process_error(position, points[i], structure, problem)
                used += k
    best = np.argmin(errors)
    found = start.copy()  # the other coordinates to the last digit: a stem may hang on it
    for axis in axes:
        found[axis] = points[best, axis]
    return found, errors[best]
