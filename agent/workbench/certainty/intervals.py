"""The parameters of a fitted model, and how sure they are.

A model has those with which it predicts best (``prediction_search.py``), with the interval of the
``likelihood_profile``, the autoregression free as well. That of what was added is at least what the
derivatives of the innovations give; those of a base say nothing of two lags that are alike. It holds what a
lag within a sample may have moved (``lag_within_a_sample.py``).
Without predictions it has those of its fit, with the delete-a-group jackknife over the folds: each leaves a
fifth of the record out, and from the scatter of the K estimates follows the variance of the one from all,
(K - 1) / K times their sum of squares about the mean, with K - 1 degrees of freedom (reconstructed from Shao
and Tu, The Jackknife and Bootstrap, 1995).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from agent.physics.effects.load_step import LoadStepEffect
from agent.workbench.certainty.free_memory import with_free_memory
from agent.workbench.certainty.lag_within_a_sample import values_beside_a_lag
from agent.workbench.certainty.likelihood_profile import (
    CLEARLY_AT_AN_INSTANT,
    QUANTILE,
    as_likely,
    by_derivatives,
    profiles,
)
from agent.workbench.event_scan import instant_p
from agent.workbench.fit_order import lags_alike, lags_in_order
from agent.workbench.paired_blocks import CONFIDENCE
from agent.workbench.residual.state_dependence import Dependence, state_dependence
from agent.workbench.solved.numbers import solved_numbers
from agent.workbench.space import space_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.folds import HeldOut
    from agent.workbench.hooks import Map
    from agent.workbench.record import Record
    from agent.workbench.space import Space
    from agent.workbench.trial import Tried


@dataclass(frozen=True, slots=True)
class FittedParameter:
    """A number of a model, with its 90 % interval, in ``unit``."""

    name: str
    unit: str
    value: float
    low: float
    high: float
    at_bound: bool = False
    """It ran into a bound of the search, and may lie beyond."""
    of_record: bool = False
    """It belongs to this record, not to the loop, like the first valve position."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """All parameters of a model, and what it makes of OP with them."""

    parameters: tuple[FittedParameter, ...]
    pv: FloatArray
    """Free run, PV units, (n,)."""
    dependence: Mapping[str, Dependence]
    """By axis, whether the loop answers OP otherwise there; empty where that is not known."""
    happened: float
    """How likely innovations of a complete model show a load step as large; 1 where that is not known."""
    solved: tuple[FittedParameter, ...] = ()
    """What was solved for: gain, heights, amplitude, phase; no gain where PV is the response itself."""


def estimated(found: Tried, record: Record, run: Map = map) -> Estimate:
    """Return the parameters of a model; of one searched by its logarithm the interval is the logarithm's.

    ``run`` works on several at a time.
    """
    fitted = found.fit
    if found.predicts is None:
        space = space_of(fitted.model, record.facts)
        half = _jackknife(space, found.held_out)
        return Estimate(_within(space, space.at(fitted.values), half), fitted.pv, {}, 1.0)
    predicts, best = found.predicts
    space = predicts.space
    freed = with_free_memory(predicts, best)
    pairs = [*zip(space.names, space.parameters, strict=True)]
    wide = [QUANTILE if each.of_record else by_derivatives(name) for name, each in pairs]
    half = np.tile(wide * freed.spread(best), (2, 1))
    points = as_likely(freed.behind, best, pairs, lags_alike(space), run)
    half = np.maximum(half, _reach(np.array([lags_in_order(space, each) for each in points]), best))
    instants = [i for i, each in enumerate(space.parameters) if each.instant and not each.constant]
    ends = profiles(freed.behind, best, instants, CLEARLY_AT_AN_INSTANT, run=run)
    for i, points in zip(instants, ends, strict=True):
        half[:, i] = np.maximum(half[:, i], _reach(points, best)[:, i])
    half = np.maximum(half, _by_law(space, best)) + _reach(values_beside_a_lag(predicts, best), best)
    parameters = _within(space, best, half)
    return Estimate(
        parameters,
        predicts.free_run(best),
        state_dependence(predicts, best),
        instant_p(predicts, best, LoadStepEffect()),
        solved=tuple(
            FittedParameter(name, unit, value, low, high)
            for name, (value, unit), low, high in solved_numbers(predicts, best)
        ),
    )


def _by_law(space: Space, best: FloatArray) -> FloatArray:
    """Return half of what another law of friction leaves open, on the unit cube, (2, k)."""
    part = np.array([each.by_law for each in space.parameters])
    values = space.values(best)
    ends = np.array([space.at(values * (1 - part)), space.at(values * (1 + part))])
    return np.where(part > 0, np.abs(ends - best), 0.0)


def _reach(points: FloatArray, best: FloatArray) -> FloatArray:
    """Return how far points, (m, k), lie from the best to either side, on the unit cube, (2, k)."""
    moved = np.vstack((np.zeros(len(best)), points - best))
    return np.array((-moved.min(axis=0), moved.max(axis=0)))


def _jackknife(space: Space, folds: HeldOut) -> FloatArray:
    """Return half the width of each interval to either side, on the unit cube, (2, k)."""
    k = len(folds.values)
    spread = np.sqrt((k - 1) * np.var(space.at(folds.values), axis=0))
    return np.tile(stats.t.ppf(0.5 + CONFIDENCE / 2, k - 1) * spread, (2, 1))


def _within(space: Space, best: FloatArray, half: FloatArray) -> tuple[FittedParameter, ...]:
    values, low, high = (space.values(at) for at in (best, best - half[0], best + half[1]))
    stopped = space.at_bound(values)
    return tuple(
        FittedParameter(
            name,
            parameter.unit,
            float(value),
            float(lowest),
            float(highest),
            at_bound=name in stopped,
            of_record=parameter.of_record,
        )
        for name, parameter, value, lowest, highest in zip(
            space.names, space.parameters, values, low, high, strict=True
        )
    )
