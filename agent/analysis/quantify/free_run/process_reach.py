"""How sure a process is behind a known path of the valve, its errors those of whole strokes.

A model errs for as long as a stroke lasts, so that its errors are no independent noise: the scores are summed
over each period, and scatter from period to period ("sandwich" or cluster-robust covariance: H. White,
Econometrica 50 (1982) 1; K.-Y. Liang and S. Zeger, Biometrika 73 (1986) 13).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from agent.identify.confidence_set import sums_of_pieces
from agent.identify.free_run_error import response_to
from agent.identify.objective import (
    DELAY,
    INTEGRATOR,
    LOG_TAU,
    LOG_TAU2,
    SOPDT,
    fit_gain,
    valve_position,
)
from agent.identify.residuals import residuals

if TYPE_CHECKING:
    from agent.identify.arrays import FloatArray
    from agent.identify.fitted import Fitted
    from agent.identify.problem import Problem

STEP = 0.01
"""Of a logarithm or of a delay in samples, for its derivative."""


def process_reach(fitted: Fitted, problem: Problem, p: float) -> dict[str, float]:
    """Return half of the interval of each number of a process that misses it with a chance of ``p``.

    Returns:
        ``gain`` as a part of the gain, ``delay`` in samples, and, where the structure has them, the
        logarithms of ``tau`` and ``tau2``; none more than the range of the search.
    """
    most = {"gain": 1.0, "delay": problem.max_delay, "tau": problem.max_log_tau, "tau2": problem.max_log_tau}
    moved = {"delay": DELAY}
    if fitted.structure != INTEGRATOR:
        moved["tau"] = LOG_TAU
    if fitted.structure == SOPDT:
        moved["tau2"] = LOG_TAU2
    position = valve_position(fitted.candidate, problem)

    def response(candidate: FloatArray) -> FloatArray:
        return response_to(position, candidate, fitted.structure, problem)

    own = response(fitted.candidate)
    _, gain, _ = fit_gain(own, fitted.candidate, fitted.structure, problem)
    columns = [gain * own]
    for at in moved.values():
        other = fitted.candidate.copy()
        other[at] += STEP
        columns.append(gain * (response(other) - own) / STEP)
    counted = np.column_stack(columns) * problem.weight[:, np.newaxis]
    counted -= problem.basis @ (problem.basis.T @ counted)
    left = residuals(fitted.candidate, fitted.structure, problem)
    scores = sums_of_pieces(left * counted.T, round(problem.period / problem.block))
    inverse = np.linalg.pinv(counted.T @ counted, hermitian=True)
    covariance = inverse @ (scores @ scores.T) @ inverse
    freedom = scores.shape[1] - 1
    wide = stats.t.ppf(1 - p / 2, freedom) * np.sqrt((freedom + 1) / freedom)
    half = (wide * np.sqrt(np.diag(covariance))).tolist()
    return {name: min(each, most[name]) for name, each in zip(("gain", *moved), half, strict=True)}
