"""One-step predictions of a model whose residual is autoregressive: the prediction-error method.

Unbiased in closed loop, as the free run is not.
Source: L. Ljung, System Identification, 2nd ed., 7.2 and 13.4.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.noise.autoregression import Innovations, innovations
from agent.workbench.fit import Fit, residual_of
from agent.workbench.objective import Objective, objective_of, whitened
from agent.workbench.projection import VANISHES, nuisance_part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.objective import Whitened
    from agent.workbench.space import Space

DIFFERENCE = 1e-3
"""Step of derivatives, part of a parameter's range."""
EXACT = 1e-7
"""Part of PV's deviation to which a file without noise is right: seven digits, more than files have."""


@dataclass(frozen=True, slots=True)
class Predictor:
    """One-step predictions of a model whose residual is autoregressive, as a function of its values."""

    objective: Objective
    behind: Whitened
    """The objective behind the filter of the autoregression, with a gain of either sign."""
    kept: NDArray[np.bool_]
    """Samples with all that the autoregression needs, (n,)."""
    pv: FloatArray
    """Whitened, the nuisance projected out, (m,)."""
    basis: FloatArray
    """Orthonormal columns of the whitened nuisance, (m, q)."""

    @property
    def noise(self) -> Innovations:
        """The autoregression."""
        return self.behind.noise

    @property
    def space(self) -> Space:
        """Of the model's parameters."""
        return self.objective.space

    def residual(self, at: FloatArray) -> FloatArray:
        """Return the innovations at a point of the unit cube, PV units, (m,); NaN where it has no answer."""
        return self._solved(at)[1]

    def error(self, at: FloatArray) -> float:
        """Return the sum of their squares; infinite where the point has no answer."""
        return self.behind.error(at)

    def variance(self, at: FloatArray) -> float:
        """Return their mean square, to compare those of other autoregressions; PV units squared.

        No less than what is rounding: a record without noise is right to some digits.
        """
        return max(self.error(at) / len(self.pv), self.rounding)

    @property
    def rounding(self) -> float:
        """Variance below which innovations are rounding, PV units squared."""
        pv = self.objective.record.pv
        return max(EXACT**2 * float(np.var(pv)), np.finfo(float).tiny)

    def free_run(self, at: FloatArray) -> FloatArray:
        """Return PV of the model in free run, PV units, (n,); level and drift as a fit takes them."""
        return self.fit(at).pv

    def left(self, at: FloatArray) -> FloatArray:
        """Return PV less the free run, PV units, (n,), NaN where PV counts for nothing."""
        return residual_of(self.fit(at), self.objective.record)

    def fit(self, at: FloatArray) -> Fit:
        """Return the model with the values of a point and the coefficients that predict best there."""
        objective, coefficients = self.objective, self._solved(at)[0]
        record, explained = objective.record, objective.columns(at) @ coefficients
        drift = 0.0 if objective.target.fixed_gain else nuisance_part(record, explained, record.weight)
        pv = np.asarray(explained + drift, dtype=np.float64)
        missed = (record.pv - pv) * record.weight
        values = objective.space.values(at)
        at_bound = objective.space.at_bound(values)
        return Fit(objective.model, values, coefficients, float(missed @ missed), pv, at_bound)

    def whitened(self, columns: FloatArray) -> FloatArray:
        """Return columns (n, k) behind the filter, where PV counts, less level and drift, (m, k)."""
        white = self.noise.filtered(columns)[self.kept]
        return np.asarray(white - self.basis @ (self.basis.T @ white), dtype=np.float64)

    def solved_for(self, columns: FloatArray) -> FloatArray:
        """Return which of the model's columns, (n, k), have free amounts: all but a response that is PV."""
        return columns[:, int(self.objective.target.fixed_gain) :]

    def left_by(self, white: FloatArray) -> FloatArray:
        """Return the innovations that whitened columns, (m, k), leave with their best amounts, (m,)."""
        free = self.solved_for(white)
        rest = self.pv - white[:, : white.shape[1] - free.shape[1]].sum(axis=1)
        return np.asarray(rest - free @ np.linalg.lstsq(free, rest, rcond=None)[0], dtype=np.float64)

    def derivative(self, at: FloatArray) -> FloatArray:
        """Return the derivatives of the innovations by the coordinates, PV units, (m, k)."""
        columns = np.empty((len(self.pv), len(at)))
        for i, place in enumerate(at.tolist()):
            ends = np.vstack((at, at))
            ends[:, i] = max(place - DIFFERENCE, 0.0), min(place + DIFFERENCE, 1.0)
            rise = self.residual(ends[1]) - self.residual(ends[0])
            columns[:, i] = rise / (ends[1, i] - ends[0, i])
        return columns

    def spread(self, at: FloatArray) -> FloatArray:
        """Return the standard deviation of each coordinate, (k,), by the derivatives of the innovations.

        What they do not show spreads over the whole cube.
        """
        derivative = self.derivative(at)
        if not np.isfinite(derivative).all():
            return np.ones(len(at))
        left = self.residual(at)
        variance = float(left @ left) / max(len(left) - len(at) - self.basis.shape[1], 1)
        information = derivative.T @ derivative / max(variance, self.rounding)
        # One more observation of each: it lies somewhere in the cube.
        covariance = np.linalg.inv(information + np.eye(len(at)))
        return np.asarray(np.sqrt(np.diag(covariance)), dtype=np.float64)

    def _solved(self, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        columns = self.objective.columns(at)
        if not np.isfinite(columns).all():
            return np.zeros(columns.shape[1]), np.full(len(self.pv), np.nan)
        white = self.whitened(columns)
        solved, free = np.ones(columns.shape[1]), self.solved_for(white)
        rest = self.pv - white[:, : white.shape[1] - free.shape[1]].sum(axis=1)
        solved[len(solved) - free.shape[1] :] = np.linalg.lstsq(free, rest, rcond=VANISHES)[0]
        return solved, self.pv - white @ solved


def with_effect(predicts: Predictor, effect: Effect) -> Predictor:
    """Return the predictions of a model with an effect more, behind the same autoregression."""
    smaller = predicts.objective
    model = replace(smaller.model, effects=(*smaller.model.effects, effect))
    objective = objective_of(model, smaller.record, smaller.target)
    behind = replace(predicts.behind, model=model, layout=objective.layout, space=objective.space)
    return replace(predicts, objective=objective, behind=behind)


def predictor_behind(objective: Objective, model_pv: FloatArray) -> Predictor | None:
    """Return the predictions behind the autoregression of what a free run leaves of PV.

    Args:
        objective: Of the model.
        model_pv: PV of that free run, PV units, (n,).

    Returns:
        None where too few samples in a row are left.
    """
    record = objective.record
    counts = record.weight > 0
    noise = innovations(np.where(counts, record.pv - model_pv, np.nan), longest=True)
    return None if noise is None else predictor_with(objective, noise)


def predictor_with(objective: Objective, noise: Innovations) -> Predictor:
    """Return the predictions of a model behind an autoregression."""
    behind = whitened(objective, noise)
    target = replace(behind.target, gain_sign=0)
    kept = target.weight > 0
    behind = replace(behind, target=target)
    return Predictor(objective, behind, kept, target.pv[kept], target.basis[kept])


def renewed(predicts: Predictor, at: FloatArray) -> Predictor | None:
    """Return the predictions behind the autoregression of what the model leaves at a point; None as above."""
    return predictor_behind(predicts.objective, predicts.free_run(at))
