"""A model on a whitened record: its likelihood, and its process fitted to it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.innovations.prewhitened import behind_autoregression
from agent.identify.noise.autoregression import MOST_LAGS, innovations
from agent.identify.noise.student import student_likelihood
from agent.identify.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    LOG_TAU,
    SOPDT,
    free_run_error,
    valve_position,
)
from agent.identify.residuals import residuals
from agent.identify.simplex import STEP, not_given, simplex

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.identify.noise.autoregression import Innovations
    from agent.identify.problem import Problem

AXES = {FOPDT: (LOG_TAU, DELAY), SOPDT: (LOG_TAU, DELAY), INTEGRATOR: (DELAY,)}
"""What is searched of a process; the second pole keeps its ratio."""
LAGS = (MOST_LAGS, 15, 7, 3)
"""Of the autoregression, which takes from the innovations what a filter of one pole left."""
LEAST_SHARE = 1e-12
"""Mean square below which an error is rounding, over that of PV."""


@dataclass(frozen=True, slots=True)
class Fit:
    """A candidate of ``free_run`` on one of the whitened records."""

    score: float
    """Log likelihood if the innovations are white, nats."""
    noise: int
    """Place of its record."""
    structure: int
    candidate: FloatArray


def white_likelihood(error: float, problem: Problem) -> float:
    """Return the log likelihood, nats, less a constant, of innovations with the sum of squares ``error``."""
    count = float(problem.weight.sum())
    least = LEAST_SHARE * float(problem.pv @ problem.pv)
    return -0.5 * count * math.log(max(error, least, 1e-300) / count)


def fitted(
    candidate: FloatArray, structure: int, problem: Problem, noise: int, evaluations: int, scale: float = 1.0
) -> Fit:
    """Return the candidate with delay and time constant fitted."""
    axes = not_given(AXES[structure], problem)
    if not axes:
        error = free_run_error(candidate, structure, problem)
    else:
        position = valve_position(candidate, problem)
        candidate, error = simplex(
            candidate, scale * STEP, np.array(axes), position, structure, problem, evaluations
        )
    score = white_likelihood(float(error), problem) if math.isfinite(error) else -math.inf
    return Fit(score, noise, structure, candidate)


def log_likelihood(fit: Fit, problem: Problem) -> float:
    """Return the log likelihood of the fit, nats, less a constant; minus infinity where that is not known.

    Its innovations are made white by an autoregression, gain and level are solved behind it: noise that is
    coloured otherwise than a walk would else count the same evidence several times. And they are taken to
    have Student's distribution, so that one step of a load is no proof of a slip.
    """
    return likelihood_behind(fit, problem, behind_noise(fit, problem))


def behind_noise(fit: Fit, problem: Problem) -> Problem | None:
    """Return the problem behind the autoregression of a fit; None where samples are too few."""
    noise = noise_of(fit, problem)
    return None if noise is None else behind_autoregression(problem, noise)


def likelihood_behind(fit: Fit, problem: Problem, behind: Problem | None) -> float:
    """Return the log likelihood of a fit to a problem that was made white; minus infinity for None."""
    if behind is None:
        return -math.inf
    new = residuals(fit.candidate, fit.structure, behind)[behind.weight > 0]
    return student_likelihood(new, LEAST_SHARE * float(problem.pv @ problem.pv) / len(new))


def noise_of(fit: Fit, problem: Problem, *, longest: bool = True) -> Innovations | None:
    """Return the autoregression of what a fit leaves behind its filter; None where samples are too few.

    Where gaps leave too few samples in a row for many lags, it has fewer. ``longest`` as in ``innovations``.
    """
    left = residuals(fit.candidate, fit.structure, problem)
    left = np.where(problem.weight > 0, left, np.nan)
    found = (innovations(left, longest=longest, lags=lags) for lags in LAGS)
    return next((each for each in found if each is not None), None)
