"""The values with which a model predicts best: the prediction-error method, unbiased in closed loop.

The free run is fitted by output error. Under large loads that lets its values drift from the truth, toward a
model that answers to the disturbance, and its error below that of the true model. Here residual and model
are whitened by the residual's own autoregression before the squares are summed, in turn with a new
autoregression. Source: L. Ljung, System Identification, 2nd ed., 7.2 and 13.4; the alternation is that of
Cochrane and Orcutt, J. Am. Stat. Assoc. 44 (1949) 32.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.hysteresis import HysteresisEffect
from agent.workbench.fit import SCAN, Fit
from agent.workbench.innovations import Innovations, innovations
from agent.workbench.instant_order import instants_of
from agent.workbench.library import happens_once
from agent.workbench.projection import VANISHES, nuisance_part, target_of
from agent.workbench.search import (
    Objective,
    lowered_by_simplex,
    objective_of,
    of_last_effect,
    searched,
    spread_about,
    whitened,
)
from agent.workbench.valve_scan import MOVED, valves

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.recording import FloatArray
    from agent.workbench.hooks import Map
    from agent.workbench.record import Record
    from agent.workbench.search import Round, Whitened
    from agent.workbench.space import Space

TURNS = 3
"""A few settle it: the autoregression hardly depends on the last per cent of the values."""
STEP = 0.02
"""First step of the search, part of a parameter's range."""
EVALUATIONS = 40
"""For each parameter, each turn."""
CLEARLY = 1e-3
"""Part of the squares that a better valley is lower by."""
ROUNDS: tuple[Round, ...] = ((4, 0.05, 20), (2, 0.02, 40))
PLACES = 400
"""Of an instant that are looked at."""
DIFFERENCE = 1e-3
"""Step of derivatives, part of a parameter's range."""


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
        """Return their mean square, to compare those of other autoregressions; PV units squared."""
        return self.error(at) / len(self.pv)

    def free_run(self, at: FloatArray) -> FloatArray:
        """Return PV of the model in free run, PV units, (n,); level and drift as a fit takes them."""
        return self.fit(at).pv

    def fit(self, at: FloatArray) -> Fit:
        """Return the model with the values of a point and the coefficients that predict best there."""
        objective, coefficients = self.objective, self._solved(at)[0]
        record, explained = objective.record, objective.columns(at) @ coefficients
        pv = np.asarray(explained + nuisance_part(record, explained, record.weight), dtype=np.float64)
        missed = (record.pv - pv) * record.weight
        values = objective.space.values(at)
        at_bound = objective.space.at_bound(values)
        return Fit(objective.model, values, coefficients, float(missed @ missed), pv, at_bound)

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

        What they do not tell spreads over the whole cube.
        """
        derivative = self.derivative(at)
        if not np.isfinite(derivative).all():
            return np.ones(len(at))
        left = self.residual(at)
        variance = float(left @ left) / max(len(left) - len(at) - self.basis.shape[1], 1)
        information = derivative.T @ derivative / max(variance, np.finfo(float).tiny)
        # One more observation of each: it lies somewhere in the cube.
        covariance = np.linalg.inv(information + np.eye(len(at)))
        return np.asarray(np.sqrt(np.diag(covariance)), dtype=np.float64)

    def _solved(self, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        columns = self.objective.columns(at)
        if not np.isfinite(columns).all():
            return np.zeros(columns.shape[1]), np.full(len(self.pv), np.nan)
        white = self.noise.filtered(columns)[self.kept]
        white -= self.basis @ (self.basis.T @ white)
        solved = np.asarray(np.linalg.lstsq(white, self.pv, rcond=VANISHES)[0], dtype=np.float64)
        return solved, self.pv - white @ solved


def predictor(
    fitted: Fit,
    record: Record,
    smaller: tuple[Predictor, FloatArray] | None = None,
    instants: FloatArray | None = None,
) -> tuple[Predictor, FloatArray] | None:
    """Return the predictions of a model with a linear base, and the point where they are best.

    Args:
        fitted: In free run; the search begins there.
        record: What it was fitted to.
        smaller: The same of the model without the last effect; None where there is none.
        instants: Values of a last effect that happened once, own units, (m, k), where the innovations of the
            smaller model show it.

    Returns:
        None where the residual has too few samples in a row.
    """
    objective = objective_of(fitted.model, record, target_of(record, record.weight, linear=True))
    start = objective.space.at(fitted.values)
    first = _predictor(objective, fitted.pv)
    if first is None:
        return None
    found = _settled(first, start)
    if found is None or not len(start):
        return found
    if any(happens_once(each, record.facts) for each in fitted.model.effects[-1:]):
        # Each turn has looked for its instants all over the record, but for those that go with its lag.
        if smaller is not None and instants is not None:
            found = min((found, *_begun(found[0], smaller, instants)), key=_variance)
        return found
    found = min((found, *_in_other_valleys(first, start, found, smaller)), key=_variance)
    if smaller is not None and _variance(smaller) < _variance(found):
        # More cannot predict worse but where the search has missed it.
        begin = np.concatenate((smaller[1], found[1][len(smaller[1]) :]))
        other = _sought(found[0], _scanned(found[0], begin))
        if other is not None:
            found = min(found, other, key=_variance)
    return found


def with_valve_anew(
    predicts: Predictor, at: FloatArray, run: Map = map
) -> tuple[Predictor, FloatArray] | None:
    """Return where the predictions are better with another valve, all else from near ``at``; None: nowhere.

    A valve that was found while another effect was missing may be the one that answers for both. ``run``
    works on several, perhaps in parallel.
    """
    objective = predicts.objective
    points = [
        each
        for effect in objective.model.effects
        if isinstance(effect, HysteresisEffect)
        for each in valves(whitened(objective, predicts.noise), at, effect.name)
    ]
    found = [each for each in run(partial(_sought, predicts), points) if each is not None]
    best = min(found, key=_variance, default=(predicts, at))
    return best if _variance(best) < (1 - CLEARLY) * predicts.variance(at) else None


def _in_other_valleys(
    first: Predictor,
    start: FloatArray,
    found: tuple[Predictor, FloatArray],
    smaller: tuple[Predictor, FloatArray] | None,
) -> list[tuple[Predictor, FloatArray]]:
    """Return where else the predictions are best, as far as other valleys are deeper."""
    objective = first.objective
    effects = objective.model.effects
    if smaller is not None and isinstance(effects[-1], HysteresisEffect):
        # What the smaller model leaves knows nothing of the valley of a wrong valve.
        at = np.concatenate((smaller[1], start[len(smaller[1]) :]))
        points = valves(whitened(objective, smaller[0].noise), at, effects[-1].name)
        others = [_sought(found[0], each) for each in points]
    else:
        # Behind the autoregression of a wrong valley that valley looks deeper than it is, or others do.
        others = [_elsewhere(first, start), _elsewhere(*found)]
    return [each for each in others if each is not None]


def _variance(found: tuple[Predictor, FloatArray]) -> float:
    return found[0].variance(found[1])


def _begun(
    predicts: Predictor, smaller: tuple[Predictor, FloatArray], instants: FloatArray
) -> list[tuple[Predictor, FloatArray]]:
    """Return where the predictions are best from those of the smaller model, with each of ``instants``.

    In free run a load whose lag is long bends with the load that wanders, and its instants are elsewhere.
    """
    others = smaller[0].space.values(smaller[1])
    points = [predicts.space.at(np.concatenate((others, own))) for own in instants]
    found = [_sought(predicts, each) for each in points]
    return [each for each in found if each is not None]


def _elsewhere(predicts: Predictor, at: FloatArray) -> tuple[Predictor, FloatArray] | None:
    """Return where the predictions are best in another valley, if one is deeper; None where none is."""
    scanned = _scanned(predicts, at)
    deeper = predicts.error(scanned) < (1 - CLEARLY) * predicts.error(at)
    return _sought(predicts, scanned) if deeper else None


def _scanned(predicts: Predictor, at: FloatArray) -> FloatArray:
    """Return the best point with the last effect anywhere, all else near ``at``.

    In closed loop a free run may have its least error in another valley, turned round by the controller: an
    inverse response that is not there, with a shorter delay.
    """
    objective = predicts.objective
    points = spread_about(at, of_last_effect(objective), MOVED, SCAN)
    return searched(whitened(objective, predicts.noise), np.vstack((at, points)), ROUNDS)


def _sought(predicts: Predictor, at: FloatArray) -> tuple[Predictor, FloatArray] | None:
    """Return the point near ``at`` where the predictions are best, behind the autoregression of ``at``."""
    there = _predictor(predicts.objective, predicts.free_run(at))
    return None if there is None else _settled(there, at)


def _settled(predicts: Predictor, at: FloatArray) -> tuple[Predictor, FloatArray] | None:
    """Return the point near ``at`` where the predictions are best, behind the autoregression of their own."""
    for turn in range(TURNS):
        again = _predictor(predicts.objective, predicts.free_run(at)) if turn else predicts
        if again is None:
            return None
        predicts = again
        flat = 1e-7 * predicts.error(at)
        if len(at):
            at = _placed(predicts, at)
            at = lowered_by_simplex(predicts.error, at, STEP, EVALUATIONS, near=1e-5, flat=flat)
    return predicts, at


def _placed(predicts: Predictor, at: FloatArray) -> FloatArray:
    """Return the point with each instant of the last effect where the predictions are best, all else kept.

    The free run puts it where the load is low, and the innovations have a needle that a simplex passes by.
    """
    placed = at.copy()
    for effect in predicts.objective.model.effects[-1:]:
        for i in instants_of(predicts, effect.name):
            tried = np.tile(placed, (PLACES + 1, 1))
            tried[1:, i] = np.linspace(0.0, 1.0, PLACES)
            placed = tried[int(np.argmin([predicts.error(each) for each in tried]))]
    return placed


def _predictor(objective: Objective, model_pv: FloatArray) -> Predictor | None:
    record = objective.record
    counts = record.weight > 0
    noise = innovations(np.where(counts, record.pv - model_pv, np.nan), longest=True)
    if noise is None:
        return None
    behind = whitened(objective, noise)
    target = replace(behind.target, gain_sign=0)
    kept = target.weight > 0
    behind = replace(behind, target=target)
    return Predictor(objective, behind, kept, target.pv[kept], target.basis[kept])
