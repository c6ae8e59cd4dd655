"""A process fitted to what is new in PV: prediction error, as in Ljung, System Identification, 2nd ed., 7.2.

Behind a filter of one pole the noise of a load that wanders is not white. In closed loop OP responds to it,
and a process that is fitted there is biased, so that a stem makes up for a part of it: of long records of
sound loops, whose set point moves far, many had 20 to 130 nats for a valve that sticks. An autoregression of
many lags leaves nothing of such noise. It is a filter, and filters may change places with the process: so
stem and PV behind it are one more record for the same search.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.identify.noise.prediction_filter import unpredicted

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.identify.noise.autoregression import Innovations
    from agent.identify.problem import Problem


def behind_autoregression(problem: Problem, noise: Innovations) -> Problem:
    """Return the problem with the filter of an autoregression behind its own."""
    weight = np.isfinite(noise.values).astype(np.float64)
    basis = np.asfortranarray(np.linalg.qr(problem.basis * weight[:, None])[0])
    pv = unpredicted(problem.pv[None], noise.coefficients)[0] * weight
    pv = (pv - basis @ (basis.T @ pv)) * weight
    op = _filtered(problem.op, problem.block, noise.coefficients)
    return problem._replace(op=op, pv=pv, weight=weight, basis=basis)


def _filtered(op: FloatArray, block: int, coefficients: FloatArray) -> FloatArray:
    """Return OP (n,), n a multiple of ``block``, behind a filter of as many blocks; before it stood still."""
    lags = len(coefficients)
    series = np.column_stack((np.full((block, lags), op[0]), op.reshape(-1, block).T))
    return np.ascontiguousarray(unpredicted(series, coefficients)[:, lags:].T).ravel()
