"""One model on several recordings: the valve and the process are the same, each recording has its own rest.

Innovations of recordings are independent, so their likelihoods multiply. Gain, level, drift and the heights
of loads are solved for in each recording; states at its start are searched for each. No state crosses from
one recording to the next.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.noise.autoregression import innovations
from agent.workbench.certainty.intervals import FittedParameter
from agent.workbench.certainty.likelihood_profile import as_likely, by_derivatives
from agent.workbench.fit import Fit
from agent.workbench.fit_order import lags_alike
from agent.workbench.gauss_newton import lowest
from agent.workbench.predictor import Predictor, predictor_behind
from agent.workbench.projection import VANISHES, nuisance_part
from agent.workbench.search import COARSE, SAME, STEPS
from agent.workbench.simplex import lowered_by_simplex
from agent.workbench.solved.numbers import solved_at
from agent.workbench.space import Space, space_of

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Facts

TURNS = 2
"""Autoregressions, each of the residual of the one before."""
STEP, EVALUATIONS = 0.02, 40
"""First step of the simplex, part of a range, and its evaluations for each number."""


@dataclass(frozen=True, slots=True)
class Joint:
    """A model on several recordings, as a function of its numbers."""

    predictors: tuple[Predictor, ...]
    """Of each recording, behind its own autoregression."""
    space: Space
    """Of the model's parameters, with the ranges of all recordings together."""
    own: NDArray[np.bool_]
    """Which parameters each recording has for itself, (k,)."""
    scales: FloatArray
    """Standard deviations of the innovations, PV units, one a recording."""

    def values(self, at: FloatArray) -> FloatArray:
        """Return the values in each recording, own units, (recordings, k), at a point of the unit cube.

        The point has the numbers that all share, then those of each recording.
        """
        shared = int(np.count_nonzero(~self.own))
        rows = np.empty((len(self.predictors), len(self.own)))
        rows[:, ~self.own] = at[:shared]
        rows[:, self.own] = at[shared:].reshape(len(self.predictors), -1)
        return self.space.values(rows)

    def at(self, values: FloatArray) -> FloatArray:
        """Return the point with the first row's shared numbers and each row's own, of ``values`` as above."""
        rows = self.space.at(values)
        return np.concatenate((rows[0, ~self.own], rows[:, self.own].ravel()))

    def residual(self, at: FloatArray) -> FloatArray:
        """Return the innovations of all recordings over their standard deviations, (samples,)."""
        rows = zip(self.predictors, self.values(at), self.scales.tolist(), strict=True)
        return np.concatenate([_solved(each, row)[1] / scale for each, row, scale in rows])

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return the same at points, (m, k), each a row, (m, samples)."""
        return np.array([self.residual(each) for each in points])

    def errors(self, points: FloatArray) -> FloatArray:
        """Return ``error`` at points, (m, k), (m,)."""
        return np.array([self.error(each) for each in points])

    def error(self, at: FloatArray) -> float:
        """Return the sum of their squares; infinite where the model has no answer."""
        left = self.residual(at)
        return float(left @ left) if np.isfinite(left).all() else np.inf

    @property
    def lags_alike(self) -> tuple[int, ...]:
        """Which coordinates are lags that may change places, the longest first, where all share them."""
        found = [*lags_alike(self.space)]
        if not found or self.own[found].any():
            return ()
        return tuple((np.cumsum(~self.own) - 1)[found].tolist())

    @property
    def count(self) -> int:
        """Samples of all recordings."""
        return sum(each.behind.count for each in self.predictors)

    @property
    def rough(self) -> bool:
        """Whether the error has steps or kinks."""
        return any(each.behind.rough for each in self.predictors)

    def fits(self, at: FloatArray) -> tuple[Fit, ...]:
        """Return the model in free run in each recording."""
        return tuple(_fit(*pair) for pair in zip(self.predictors, self.values(at), strict=True))


@dataclass(frozen=True, slots=True)
class JointFit:
    """A model fitted to several recordings at once."""

    joint: Joint
    at: FloatArray
    """Point of the unit cube, the shared numbers first."""
    fits: tuple[Fit, ...]
    """In each recording."""
    unlikely: float
    """Minus twice the logarithm of the likelihood, less a constant, its numbers paid (Schwarz 1978)."""

    def shared(self) -> tuple[FittedParameter, ...]:
        """Return each number that all share, with its 90 % interval, as ``certainty/intervals.py`` has it."""
        joint, columns = self.joint, np.flatnonzero(~self.joint.own)
        names = [joint.space.names[column] for column in columns]
        parameters = [joint.space.parameters[column] for column in columns]
        half = self.spread() * [by_derivatives(name) for name in names]
        pairs, alike = [*zip(names, parameters, strict=True)], joint.lags_alike
        points, best = as_likely(joint, self.at, pairs, alike)[:, : len(columns)], self.at[: len(columns)]
        points[:, alike] = np.sort(points[:, alike], axis=1)[:, ::-1]
        low = np.clip(np.minimum(points.min(axis=0), best - half), 0.0, 1.0)
        high = np.clip(np.maximum(points.max(axis=0), best + half), 0.0, 1.0)
        ends = [np.concatenate((each, self.at[len(columns) :])) for each in (best, low, high)]
        value, least, most = (joint.values(each)[0, columns].tolist() for each in ends)
        return tuple(
            FittedParameter(name, parameter.unit, *numbers)
            for name, parameter, *numbers in zip(names, parameters, value, least, most, strict=True)
        )

    def own(self) -> list[dict[str, float]]:
        """Return what each recording has for itself: what is solved for there, and its own numbers."""
        joint, found = self.joint, []
        names = [name for name, is_own in zip(joint.space.names, joint.own.tolist(), strict=True) if is_own]
        for predicts, fit, row in zip(joint.predictors, self.fits, joint.values(self.at), strict=True):
            solved = {name: value for name, (value, _) in solved_at(predicts, row, fit.coefficients).items()}
            searched = dict(zip(names, row[joint.own].tolist(), strict=True))
            found.append({**solved, **searched})
        return found

    def spread(self) -> FloatArray:
        """Return the standard deviation of each shared number, parts of its range."""
        derivative = np.column_stack([self._derivative(i) for i in range(len(self.at))])
        information = derivative.T @ derivative + np.eye(len(self.at))
        shared = int(np.count_nonzero(~self.joint.own))
        return np.asarray(np.sqrt(np.diag(np.linalg.inv(information)))[:shared], dtype=np.float64)

    def _derivative(self, i: int) -> FloatArray:
        ends = np.vstack((self.at, self.at))
        ends[:, i] = max(self.at[i] - COARSE, 0.0), min(self.at[i] + COARSE, 1.0)
        rise = self.joint.residual(ends[1]) - self.joint.residual(ends[0])
        return np.asarray(rise / (ends[1, i] - ends[0, i]), dtype=np.float64)


def fitted_together(
    alone: Sequence[tuple[Predictor, FloatArray]], own: Collection[str] = (), start: FloatArray | None = None
) -> JointFit | None:
    """Fit one model to all recordings, from where it predicts best in each alone.

    Args:
        alone: The same model on each recording, and the point of the unit cube where it predicts best there.
        own: Parameters that each recording has for itself, beside those of its start.
        start: Values, own units, (k,), to begin from beside those.

    Returns:
        None where a recording has too few samples in a row.
    """
    predictors = tuple(each for each, _ in alone)
    model = predictors[0].objective.model
    space = space_of(model, _facts_of_all([each.objective.facts for each in predictors]))
    is_own = np.array(
        [each.of_record or name in own for name, each in zip(space.names, space.parameters, strict=True)],
        dtype=np.bool_,
    )
    best = np.array([each.space.values(at) for each, at in alone])
    scales = np.array([np.sqrt(each.variance(at)) for each, at in alone])
    joint = Joint(predictors, space, is_own, np.maximum(scales, np.finfo(float).tiny))
    starts = [joint.at(np.where(is_own, best, row)) for row in (*best, best.mean(axis=0))]
    if start is not None:
        starts.append(joint.at(np.where(is_own, best, start)))
    at = min((_lowered(joint, each) for each in starts), key=joint.error)
    for _ in range(TURNS):
        fits = joint.fits(at)
        behind = [
            predictor_behind(each.objective, one.pv) for each, one in zip(predictors, fits, strict=True)
        ]
        if any(each is None for each in behind):
            return None
        joint = replace(joint, predictors=tuple(each for each in behind if each is not None))
        at = _lowered(joint, at)
    alike = [*joint.lags_alike]
    at[alike] = np.sort(at[alike])[::-1]
    return _judged(joint, at)


def _lowered(joint: Joint, start: FloatArray) -> FloatArray:
    found = lowest(joint.residuals, start, STEPS, COARSE)
    if not joint.rough:
        return found
    return lowered_by_simplex(joint.errors, found, STEP, EVALUATIONS, near=1.0, flat=SAME)


def _judged(joint: Joint, at: FloatArray) -> JointFit | None:
    fits, unlikely, samples = joint.fits(at), 0.0, 0
    for predicts, one in zip(joint.predictors, fits, strict=True):
        record = predicts.objective.record
        left = innovations(np.where(record.weight > 0, record.pv - one.pv, np.nan), longest=True)
        if left is None:
            return None
        count = int(np.count_nonzero(np.isfinite(left.values)))
        unlikely += count * float(np.log(max(left.variance, np.finfo(float).tiny)))
        samples += count
    constants = len(joint.space) - joint.space.searched
    numbers = len(at) - constants + sum(len(one.coefficients) for one in fits)
    return JointFit(joint, at, fits, unlikely + numbers * float(np.log(samples)))


def _solved(predicts: Predictor, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the best coefficients in one recording, and its innovations, PV units, (m,)."""
    objective = predicts.objective
    columns = objective.layout.columns(objective.record.op, values)
    if not np.isfinite(columns).all():
        return np.zeros(columns.shape[1]), np.full(len(predicts.pv), np.nan)
    white = predicts.whitened(columns)
    solved = np.asarray(np.linalg.lstsq(white, predicts.pv, rcond=VANISHES)[0], dtype=np.float64)
    return solved, predicts.pv - white @ solved


def _fit(predicts: Predictor, values: FloatArray) -> Fit:
    objective, coefficients = predicts.objective, _solved(predicts, values)[0]
    record = objective.record
    explained = objective.layout.columns(record.op, values) @ coefficients
    pv = np.asarray(explained + nuisance_part(record, explained, record.weight), dtype=np.float64)
    missed = (record.pv - pv) * record.weight
    return Fit(objective.model, values, coefficients, float(missed @ missed), pv, ())


def _facts_of_all(facts: Sequence[Facts]) -> Facts:
    """Return facts whose ranges hold those of each recording."""
    return replace(
        facts[0],
        samples=max(each.samples for each in facts),
        op_low=min(each.op_low for each in facts),
        op_high=max(each.op_high for each in facts),
        pv_low=min(each.pv_low for each in facts),
        pv_high=max(each.pv_high for each in facts),
        period=max(each.period for each in facts),
        op_speed=max(each.op_speed for each in facts),
    )
