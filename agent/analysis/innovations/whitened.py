"""A model on a whitened record: its likelihood, and its process fitted to it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.free_run_error import free_run_error
from agent.identify.noise.student import student_likelihood
from agent.identify.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    LOG_TAU,
    SOPDT,
    valve_position,
)
from agent.identify.residuals import residuals
from agent.identify.simplex import STEP, not_given, simplex
from agent.identify.white_view import behind_autoregression, noise_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.identify.problem import Problem

AXES = {FOPDT: (LOG_TAU, DELAY), SOPDT: (LOG_TAU, DELAY), INTEGRATOR: (DELAY,)}
"""What is searched of a process; the second pole keeps its ratio."""
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
    noise = noise_of(fit.candidate, fit.structure, problem)
    return None if noise is None else behind_autoregression(problem, noise)


def likelihood_behind(fit: Fit, problem: Problem, behind: Problem | None) -> float:
    """Return the log likelihood of a fit to a problem that was made white; minus infinity for None."""
    if behind is None:
        return -math.inf
    new = residuals(fit.candidate, fit.structure, behind)[behind.weight > 0]
    return student_likelihood(new, LEAST_SHARE * float(problem.pv @ problem.pv) / len(new))
