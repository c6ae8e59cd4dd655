"""The least innovations of a model near its fit: the prediction-error method, unbiased in closed loop.

The free run is fitted by output error. In closed loop that lets process and gain drift from the truth, toward
a model that answers to the disturbance; an effect that is not there but leads them back would seem to tell
more. So models are compared where each predicts best: process and gain are moved, the effects are kept.
Source: L. Ljung, System Identification, 2nd ed., 13.4 (direct method).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import minimize

from agent.workbench.innovations import Innovations, innovations
from agent.workbench.projection import target_of
from agent.workbench.search import objective_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.recording import FloatArray
    from agent.workbench.fit import Fit
    from agent.workbench.record import Record

EVALUATIONS = 25
"""For each number that moves."""
STEP = 0.04
"""First step, part of a parameter's range, and of the gain."""


def least_innovations(fitted: Fit, record: Record, starts: Sequence[FloatArray]) -> Innovations | None:
    """Return the innovations of a model with a linear base, least over process and gain.

    Args:
        fitted: The model.
        record: What it was fitted to.
        starts: Values of the base to begin from, own units, each (k,).

    Returns:
        None where the residual has too few samples in a row.
    """
    found = [_searched(fitted, record, process) for process in starts]
    return min((each for each in found if each is not None), key=lambda each: each.variance, default=None)


def _searched(fitted: Fit, record: Record, process: FloatArray) -> Innovations | None:
    target = target_of(record, record.weight, linear=True)
    objective = objective_of(fitted.model, record, target)
    begin = fitted.values.copy()
    begin[: len(process)] = process
    begin = objective.space.at(begin)
    gain = fitted.coefficients[0]

    def left(moved: FloatArray) -> FloatArray:
        at = begin.copy()
        at[: len(process)] = moved[:-1]
        columns = objective.columns(at) @ np.concatenate(([gain * moved[-1]], fitted.coefficients[1:]))
        free = columns * target.weight
        rest = target.pv - (free - target.basis @ (target.basis.T @ free))
        return np.where(target.weight > 0, rest, np.nan)

    def variance(moved: FloatArray) -> float:
        found = innovations(left(moved))
        return np.inf if found is None else found.variance

    start = np.concatenate((begin[: len(process)], [1.0]))
    steps = np.where(start[:-1] + STEP > 1.0, -STEP, STEP)
    simplex = np.vstack((start, start + np.diag(np.concatenate((steps, [STEP])))))
    found = minimize(
        variance,
        start,
        method="Nelder-Mead",
        bounds=[*[(0.0, 1.0)] * len(process), (0.1, 4.0)],
        options={"initial_simplex": simplex, "maxfev": EVALUATIONS * len(start), "xatol": 1e-3},
    )
    return innovations(left(found.x))
