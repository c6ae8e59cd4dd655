"""The part of a residual that its own past does not predict.

In closed loop OP answers to the residual: the two go together though no effect is missing. What is new in
the residual at an instant cannot have moved OP before that instant, so tests against earlier OP are fair, and
a process that is fitted to what is new is the true one (Ljung, System Identification, 2nd ed., 13.4), as long
as the autoregression has enough lags.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy import linalg

from agent.identify.noise.prediction_filter import unpredicted

if TYPE_CHECKING:
    from agent.identify.arrays import FloatArray

MOST_LAGS = 30
ROWS_A_LAG = 10
"""Samples for each coefficient, at least."""
ROUND_OFF = 1e-10
"""Added to the squares, as a part of them, so that a wave without noise has a solution as well."""


@dataclass(frozen=True, slots=True)
class Innovations:
    """A residual as an autoregression: e(t) = r(t) - c - a_1 r(t-1) - ... - a_p r(t-p)."""

    values: FloatArray
    """e, unit of the residual, (n,); NaN where a sample it needs is missing."""
    coefficients: FloatArray
    """a, (p,); p = 0 where the residual is white."""
    variance: float
    """Of e, square of the residual's unit, with the degrees of freedom that the fit took."""

    def filtered(self, other: FloatArray, before: float = math.nan) -> FloatArray:
        """Return another series (n,), or several (n, k), less the same sum over its own past.

        The first p samples are ``before``.
        """
        series = np.ascontiguousarray(other.T, dtype=np.float64)
        left = unpredicted(series.reshape(-1, len(other)), self.coefficients)
        left[:, : len(self.coefficients)] = before
        return left.reshape(series.shape).T


def innovations(residual: FloatArray, *, longest: bool = False, lags: int = MOST_LAGS) -> Innovations | None:
    """Fit an autoregression by least squares, its order by Schwarz's criterion (Ann. Statist. 6 (1978) 461).

    Args:
        residual: (n,), NaN where there is none.
        longest: Of ``lags`` instead. What few lags leave of a load biases all that is fitted behind them in
            closed loop.
        lags: At most; fewer in a short residual.

    Returns:
        None where there are too few samples in a row, or the residual is constant.
    """
    # The first samples have no past of so many: they are no rows.
    most = min(lags, (int(np.isfinite(residual).sum()) - ROWS_A_LAG) // (ROWS_A_LAG + 1))
    if most < 0:
        return None
    rows = sliding_window_view(residual - np.nanmean(residual), most + 1)
    complete = np.isfinite(rows).all(axis=1)
    count = int(complete.sum())
    if count < ROWS_A_LAG * (most + 1) or np.ptp(rows[complete, -1]) == 0:
        return None
    now = rows[complete, -1]
    past = np.column_stack((np.ones(count), rows[complete, -2::-1]))
    gram = past.T @ past
    gram[np.diag_indices_from(gram)] *= 1 + ROUND_OFF
    factor = linalg.cholesky(gram, lower=True)
    weights = linalg.solve_triangular(factor, past.T @ now, lower=True)
    squares = np.maximum(now @ now - np.cumsum(weights**2), np.finfo(float).tiny)
    terms = np.arange(1, most + 2)
    by_schwarz = 1 + int(np.argmin(count * np.log(squares / count) + terms * np.log(count)))
    kept = most + 1 if longest else by_schwarz
    solved = linalg.solve_triangular(factor[:kept, :kept].T, weights[:kept])
    values = np.full(len(residual), np.nan)
    values[most:][complete] = now - past[:, :kept] @ solved
    return Innovations(values, solved[1:], float(squares[kept - 1] / (count - kept)))
