"""The record behind the autoregression of what a model leaves: prediction error, as in Ljung.

Behind a filter of one pole the noise of a load that wanders is not white. In closed loop OP responds to it,
and a model that is fitted there is biased: so that a stem makes up for a part of it, and of two valves the
one that follows the load looks better. An autoregression of many lags leaves nothing of such noise, and least
squares of the innovations are the likelihood of the record. It is a filter, and filters may change places
with the process: so PV behind it is one more view of the record for the same search.

Source: L. Ljung, System Identification, 2nd ed., 7.2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.identify.noise.autoregression import MOST_LAGS, innovations
from agent.identify.noise.prediction_filter import unpredicted
from agent.identify.residuals import residuals

if TYPE_CHECKING:
    from agent.identify.arrays import FloatArray
    from agent.identify.noise.autoregression import Innovations
    from agent.identify.problem import Problem

LAGS = (MOST_LAGS, 15, 7, 3)
"""Of the autoregression: fewer where gaps leave too few samples in a row for many."""


def noise_of(
    candidate: FloatArray, structure: int, problem: Problem, *, longest: bool = True
) -> Innovations | None:
    """Return the autoregression of what a candidate leaves of PV; None where samples are too few.

    ``longest`` as in ``innovations``.
    """
    left = residuals(candidate, structure, problem)
    left = np.where(problem.weight > 0, left, np.nan)
    found = (innovations(left, longest=longest, lags=lags) for lags in LAGS)
    return next((each for each in found if each is not None), None)


def behind_autoregression(problem: Problem, noise: Innovations) -> Problem:
    """Return the problem with the filter of an autoregression behind its own.

    Level, slope and start-up are behind it what they were, but for their amounts.
    """
    weight = np.isfinite(noise.values).astype(np.float64)
    basis = np.asfortranarray(np.linalg.qr(problem.basis * weight[:, None])[0])
    pv = unpredicted(problem.pv[None], noise.coefficients)[0] * weight
    pv = (pv - basis @ (basis.T @ pv)) * weight
    return problem._replace(pv=pv, weight=weight, basis=basis, whitening=noise.coefficients)
