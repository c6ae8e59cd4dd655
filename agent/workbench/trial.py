"""One effect tried on top of a model: fitted to the whole record, and to each fold."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import SpottedEffect
from agent.physics.effects.hysteresis import HysteresisEffect
from agent.physics.effects.load_step import LoadStepEffect
from agent.physics.effects.sinusoid import Sinusoid
from agent.physics.foreign import EffectError
from agent.workbench.event_scan import instants_seen
from agent.workbench.evidence import criterion_of, far_likelier
from agent.workbench.first.first_fit import FirstFit, first_fit
from agent.workbench.fit import Fit, fit_from, nested_fit, refit, residual_of
from agent.workbench.fit_order import largest_first
from agent.workbench.folds import Folds, HeldOut, held_out
from agent.workbench.library import happens_once
from agent.workbench.prediction_search import predictor
from agent.workbench.solved.fewest_steps import with_steps
from agent.workbench.solved.more_harmonics import with_more_harmonics
from agent.workbench.valve_starts import ValveStart, with_valve

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.physics.loop_model import LoopModel
    from agent.workbench.predictor import Predictor
    from agent.workbench.record import Record


@dataclass(frozen=True, slots=True)
class Trial:
    """What to try; travels to another process."""

    smaller: Fit
    effect: Effect
    record: Record
    folds: Folds
    predicts: tuple[Predictor, FloatArray] | None = None
    """Where the smaller model predicts best; None where that is not known."""
    valves: tuple[ValveStart, ...] = ()
    """That the quantifier found, to start from."""
    instants: FloatArray | None = None
    """Values of an effect that happened once, own units, (m, k), to start from."""
    first: FirstFit | None = None
    """Of ``first_of``; None: it is made with the search."""

    @property
    def criterion(self) -> float:
        """How much likelier the record is by the first fit, twice a logarithm; infinite without one."""
        return np.inf if self.first is None else self.first.criterion


@dataclass(frozen=True, slots=True)
class Optimum:
    """A model where it is best."""

    fit: Fit
    """With the least error in free run."""
    predicts: tuple[Predictor, FloatArray] | None
    """Where it predicts best; None where it has no predictions."""


@dataclass(frozen=True, slots=True)
class Tried(Optimum):
    """And how it does on blocks that it did not see."""

    held_out: HeldOut
    """In free run too. Its refits are those that predict best or those of the least free-run error, whichever
    have less: in closed loop the latter lean on the load, the former on what an incomplete model does not
    say."""


def first_of(trial: Trial) -> FirstFit | None:
    """Return the first fit of the effect; None where the smaller model has no predictions."""
    if trial.predicts is None:
        return None
    predicts, best = trial.predicts
    starts = _starts(trial, predicts.space.values(best), predicts.left(best))
    return first_fit(predicts, best, trial.effect, starts)


def begins_or_failed(trial: Trial) -> tuple[FloatArray | None, FirstFit | None] | EffectError:
    """Return ``instants`` and ``first`` of a trial without them.

    Or how an effect that others wrote failed: it costs its own trial only.
    """
    try:
        instants = None
        if trial.predicts is not None and happens_once(trial.effect, trial.record.facts):
            instants = instants_seen(*trial.predicts, trial.effect)
        return instants, first_of(replace(trial, instants=instants))
    except EffectError as error:
        return error


def tried_or_failed(trial: Trial) -> Tried | EffectError:
    """Return ``tried``, or how an effect that others wrote failed."""
    try:
        return tried(trial)
    except EffectError as error:
        return error


def tried(trial: Trial) -> Tried:
    """Fit the model with the effect, and predict each fold."""
    return with_held_out(optimum(trial), trial.record, trial.folds)


def optimum(trial: Trial) -> Optimum:
    """Fit the model with the effect, from its first fit; a wave, which an autoregression predicts, anew."""
    model, record, first = _larger(trial), trial.record, trial.first or first_of(trial)
    if first is None or isinstance(trial.effect, Sinusoid):
        known = trial.smaller.values
        starts = _starts(trial, known, residual_of(trial.smaller, record))
        fitted = nested_fit(known, model, record, starts)
    else:
        fitted = fit_from(model, record, first.values)
    found = _optimum(fitted, record, first, _where_it_predicts(trial))
    return with_all_harmonics(_with_fewest_steps(found, record), record)


def _with_fewest_steps(found: Optimum, record: Record) -> Optimum:
    """Return a model whose last effect is steps of a load with as many as the record needs.

    A load that steps once is judged by the numbers of one step: two more would cost it 40 of twice a
    logarithm.
    """
    effect = found.fit.model.effects[-1]
    if isinstance(effect, LoadStepEffect):
        for steps in range(1, effect.steps):
            fewer = _optimum(with_steps(found.fit, record, steps), record)
            if not far_likelier(fewer, found, record):
                return fewer
    return found


def with_all_harmonics(found: Optimum, record: Record) -> Optimum:
    """Return a model with as many harmonics of its wave, if it has one, as the record needs.

    Of a load of edges few say little: an autoregression predicts them, and the edges remain. So each number
    of harmonics is compared behind its own, and the likeliest is fitted.
    """
    while larger := with_more_harmonics(found.fit, record):
        likeliest = max(larger, key=lambda each: criterion_of(found, Optimum(each, None), record))
        more = _optimum(refit(likeliest, record, record.weight), record)
        if not far_likelier(found, more, record):
            break
        found = more
    return found


def predicted(fitted: Fit, record: Record, folds: Folds) -> Tried:
    """Return a fit where it predicts best too, with its held-out error."""
    return with_held_out(_optimum(fitted, record), record, folds)


def with_held_out(found: Optimum, record: Record, folds: Folds) -> Tried:
    """Return a model with its held-out error."""
    own = held_out(found.fit, record, folds)
    if found.predicts is not None:
        predicts, best = found.predicts
        other = held_out(predicts.fit(best), record, folds, predicts.noise)
        own = min(other, own, key=lambda each: each.rmse)
    return Tried(found.fit, found.predicts, own)


def _optimum(
    fitted: Fit, record: Record, nested: FirstFit | None = None, starts: FloatArray | None = None
) -> Optimum:
    """Return where a fit predicts best; ``nested`` and ``starts`` as ``predictor`` takes them."""
    found = predictor(fitted, record, nested, starts)
    if found is None:
        return Optimum(fitted, None)
    predicts, best = found[0], largest_first(*found)
    if predicts.fit(best).error < fitted.error:
        fitted = refit(predicts.fit(best), record, record.weight)  # the search in free run had missed it
    return Optimum(fitted, (predicts, best))


def _larger(trial: Trial) -> LoopModel:
    model = trial.smaller.model
    return replace(model, effects=(*model.effects, trial.effect))


def beside(values: FloatArray, own: FloatArray) -> FloatArray:
    """Return values (m, k + j) of a larger model: those of the smaller, (k,), beside ``own`` (m, j)."""
    return np.hstack((np.tile(values, (len(own), 1)), own))


def _where_it_predicts(trial: Trial) -> FloatArray | None:
    """Return values to begin from, (m, k), own units, the others where the smaller model predicts best."""
    if trial.instants is None or trial.predicts is None:
        return _valves(trial)
    predicts, best = trial.predicts
    return beside(predicts.space.values(best), trial.instants)


def _starts(trial: Trial, values: FloatArray, residual: FloatArray) -> FloatArray | None:
    """Return values of the larger model to begin from, (m, k + j), own units; None: there are none.

    Args:
        trial: What to try.
        values: Of the smaller model, (k,), beside what the residual shows; valves have their own processes.
        residual: That these values leave, PV units, (n,).
    """
    own = _spots(trial, residual)
    return beside(values, own) if len(own) else _valves(trial)


def _spots(trial: Trial, residual: FloatArray) -> FloatArray:
    """Return values of the effect that a residual (n,) shows, own units, (m, j)."""
    effect = trial.effect
    spots = [np.empty((0, len(effect.parameters(trial.record.facts))))]
    if trial.instants is not None:
        spots.append(trial.instants)
    if isinstance(effect, SpottedEffect):
        spots.append(effect.spotted(residual, trial.record.facts))
    return np.vstack(spots)


def _valves(trial: Trial) -> FloatArray | None:
    """Return the valves that the quantifier found as values of the larger model, (m, k), own units."""
    effect = trial.effect
    if not trial.valves or not isinstance(effect, HysteresisEffect):
        return None
    names = tuple(name for name, _ in trial.smaller.model.parameters(trial.record.facts))
    return np.array(
        [
            np.concatenate(
                (old, effect.values_of(valve.bands, valve.start, valve.stem, trial.record.facts.ts))
            )
            for valve in trial.valves
            for old in (with_valve(trial.smaller.values, names, valve), trial.smaller.values)
        ]
    )
