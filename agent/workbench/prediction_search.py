"""The values with which a model predicts best: the prediction-error method, unbiased in closed loop.

The free run is fitted by output error. Under large loads that lets its values drift from the truth, toward a
model that answers to the disturbance, and its error below that of the true model. Here residual and model
are whitened by the residual's own autoregression before the squares are summed, in turn with a new
autoregression. Source: L. Ljung, System Identification, 2nd ed., 7.2 and 13.4; the alternation is that of
Cochrane and Orcutt, J. Am. Stat. Assoc. 44 (1949) 32.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.physics.bases.base import StartingBase
from agent.workbench.fit import SCAN
from agent.workbench.fit_order import instants_of
from agent.workbench.library import happens_once
from agent.workbench.objective import objective_of, whitened
from agent.workbench.predictor import predictor_behind, predictor_with, renewed
from agent.workbench.projection import target_of
from agent.workbench.search import best_of, by_slopes, lowered, of_last_effect, searched, spread_about

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.first.first_fit import FirstFit
    from agent.workbench.fit import Fit
    from agent.workbench.predictor import Predictor
    from agent.workbench.record import Record
    from agent.workbench.search import Round

TURNS, MOST_TURNS = 3, 20
"""Of each start, and of a valve or an event from the best of all at most: mostly a few settle it, as the
autoregression hardly depends on the last per cent of the values; in a long bent valley each moves both."""
STEP = 0.02
"""First step of the search, part of a parameter's range."""
EVALUATIONS = 40
"""For each parameter, each turn."""
CLEARLY = 1e-3
"""Part of the squares that a better valley is lower by."""
ROUNDS: tuple[Round, ...] = ((4, 0.05, 20), (2, 0.02, 40))
MOVED = (-0.2, 0.2)
"""How far half of the points of a scan move what is not the last effect's, parts of a parameter's range."""
BEST = 6
"""Points that are searched from."""
PLACES = 400
"""Of an instant that are looked at,"""
PLACED = 2
"""in the first turns: behind the autoregression of a wrong instant the true one may not be the best."""


def predictor(
    fitted: Fit,
    record: Record,
    nested: FirstFit | None = None,
    starts: FloatArray | None = None,
) -> tuple[Predictor, FloatArray] | None:
    """Return the predictions of a model, and the point where they are best.

    Args:
        fitted: In free run; the search begins there.
        record: What it was fitted to.
        nested: Its first fit on top of the model without the last effect, so that it predicts no worse than
            that; None where there is none.
        starts: Values to begin from as well, own units, (m, k): of an event those that the innovations of the
            smaller model show, of a valve those that the quantifier found.

    Returns:
        None where the residual has too few samples in a row.
    """
    found = _best_of_starts(fitted, record, nested, starts)
    return None if found is None else _settled_wholly(*found)


def _best_of_starts(
    fitted: Fit, record: Record, nested: FirstFit | None, starts: FloatArray | None
) -> tuple[Predictor, FloatArray] | None:
    """Return what ``predictor`` does, after a few turns."""
    objective = objective_of(
        fitted.model, record, target_of(record, record.weight, linear=fitted.model.base.linear)
    )
    start = objective.space.at(fitted.values)
    first = predictor_behind(objective, fitted.pv)
    if first is None:
        return None
    if starts is None:
        starts = _of_base(first)
    points = None if starts is None else objective.space.at(starts)
    found = _settled(first, start)
    if found is None or not len(start):
        return found
    if nested is not None:
        found = _deeper(found, nested)
    if any(happens_once(each, record.facts) for each in fitted.model.effects[-1:]):
        # Each turn has looked for its instants all over the record, but for those that go with its lag.
        if points is not None:
            found = min((found, *_from_best_of(found[0], points)), key=_variance)
        return found
    if points is not None:
        return min((found, *_from_best_of(found[0], points)), key=_variance)
    # Behind the autoregression of a wrong valley that valley looks deeper than it is, or others do; a first
    # fit was sought behind that of the smaller model already.
    others = [_elsewhere(*found), None if nested is not None else _elsewhere(first, start)]
    return min((found, *(each for each in others if each is not None)), key=_variance)


def _of_base(predicts: Predictor) -> FloatArray | None:
    """Return where a linear base alone would begin behind the autoregression, own units, (m, k).

    The filter is that of both OP and PV, so that the process between them is the same. None where the base
    has no first values of its own, or there are effects.
    """
    base, record = predicts.objective.model.base, predicts.objective.record
    if predicts.objective.model.effects or not (base.linear and isinstance(base, StartingBase)):
        return None
    op, pv = (
        predicts.noise.filtered(each)[len(predicts.noise.coefficients) :] for each in (record.op, record.pv)
    )
    found = base.starts(op, pv, record.facts)
    return found if len(found) else None


def with_other_values(
    predicts: Predictor, at: FloatArray, points: FloatArray
) -> tuple[Predictor, FloatArray] | None:
    """Return where the predictions are better, searched from the best of ``points`` (m, k); None: nowhere.

    A valve that was found while another effect was missing may be the one that answers for both.
    """
    best = min(_from_best_of(predicts, points), key=_variance, default=(predicts, at))
    return _settled_wholly(*best) if _variance(best) < (1 - CLEARLY) * predicts.variance(at) else None


def _from_best_of(predicts: Predictor, points: FloatArray) -> list[tuple[Predictor, FloatArray]]:
    """Return where the predictions are best from each of the best of ``points`` (m, k)."""
    found = [_sought(predicts, each) for each in best_of(predicts.behind, points, BEST)]
    return [each for each in found if each is not None]


def _variance(found: tuple[Predictor, FloatArray]) -> float:
    return found[0].variance(found[1])


def _elsewhere(predicts: Predictor, at: FloatArray) -> tuple[Predictor, FloatArray] | None:
    """Return where the predictions are best in another valley, if one is deeper; None where none is."""
    scanned = _scanned(predicts, at)
    deeper = predicts.error(scanned) < (1 - CLEARLY) * predicts.error(at)
    return _sought(predicts, scanned) if deeper else None


def _deeper(found: tuple[Predictor, FloatArray], first: FirstFit) -> tuple[Predictor, FloatArray]:
    """Return where the predictions are best from a first fit, if that is deeper; else what was found.

    Behind the autoregression of the first fit, and behind that of what the gains of what was found leave
    there: behind that of a wrong valley the wrong one looks deeper, and its gains are those of that one.
    """
    predicts, at = found
    other = predicts.space.at(first.values)
    deeper = predicts.error(other) < (1 - CLEARLY) * predicts.error(at)
    ends = [found]
    for own in (predictor_with(predicts.objective, first.noise), renewed(predicts, other)):
        if own is not None and (deeper or own.variance(other) < (1 - CLEARLY) * predicts.variance(at)):
            sought = _settled(own, other)
            ends += [(own, other), *([] if sought is None else [sought])]
    return min(ends, key=_variance)


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
    there = renewed(predicts, at)
    return None if there is None else _settled(there, at)


def _settled(predicts: Predictor, at: FloatArray) -> tuple[Predictor, FloatArray] | None:
    """Return the point near ``at`` where the predictions are best, behind the autoregression of their own."""
    for turn in range(TURNS):
        again = renewed(predicts, at) if turn else predicts
        if again is None:
            return None
        predicts = again
        if turn < PLACED:  # the autoregression needs no more than the slopes say
            at = by_slopes(predicts.behind, _placed(predicts, at))
        else:
            at = lowered(predicts.behind, at, STEP, EVALUATIONS)
    return predicts, at


def _settled_wholly(predicts: Predictor, at: FloatArray) -> tuple[Predictor, FloatArray]:
    """Return where the predictions are best after as many turns as make them clearly better.

    Of what is rough: valves and events have such valleys, and a process alone is settled by the first turns.
    """
    if not predicts.objective.rough:
        return predicts, at
    for _ in range(MOST_TURNS - TURNS):
        own = renewed(predicts, at)
        if own is None:
            break
        moved = lowered(own.behind, at, STEP, EVALUATIONS)
        if own.variance(moved) > (1 - CLEARLY) * predicts.variance(at):
            break
        predicts, at = own, moved
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
            placed = tried[int(np.argmin(predicts.behind.errors(tried)))]
    return placed
