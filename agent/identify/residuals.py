"""What a model leaves of PV, and whether it is noise.

A wrong valve errs for as long as a stroke lasts; noise is forgotten within few samples.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.free_run_error import response_to
from agent.identify.objective import (
    INTEGRATOR,
    LOG_TAU,
    fit_gain,
    valve_position,
)

if TYPE_CHECKING:
    from agent.identify.arrays import FloatArray
    from agent.identify.fitted import Fitted
    from agent.identify.problem import Problem

PART = 1 / 8
"""Of a period, after which little of noise remains and an error of the valve still lasts."""
LEAST_LAG = 2
"""Blocks; neighbours are alike by the fraction of a delay alone, and those after them not by white noise."""


def residuals(candidate: FloatArray, structure: int, problem: Problem) -> FloatArray:
    """Return high-passed PV minus the model, zero where it does not count, PV units, (m,)."""
    position = valve_position(candidate, problem)
    response = response_to(position, candidate, structure, problem)
    _, gain, start_up = fit_gain(response, candidate, structure, problem)
    modelled = gain * response
    if structure != INTEGRATOR:
        blocks = np.arange(len(response))
        modelled += start_up * np.exp(-problem.block * blocks / math.exp(candidate[LOG_TAU]))
    modelled *= problem.weight
    return problem.pv - modelled + problem.basis @ (problem.basis.T @ modelled)


def lasting(fitted: Fitted, problem: Problem) -> float:
    """Return the autocorrelation of the residuals an eighth of a period on, -1 to 1."""
    return autocorrelation(fitted, problem, max(LEAST_LAG, round(PART * problem.period / problem.block)))


def autocorrelation(fitted: Fitted, problem: Problem, lag: int) -> float:
    """Return that of the residuals ``lag`` blocks on, -1 to 1; both of a pair must count."""
    left = residuals(fitted.candidate, fitted.structure, problem)
    total = float(left @ left)
    return float(left[lag:] @ left[:-lag]) / total if total > 0 else 0.0
