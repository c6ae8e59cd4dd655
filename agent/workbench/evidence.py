"""How much likelier a record is with an effect than without, and how likely its innovations fall by chance.

In closed loop OP holds the controller's reaction to the disturbance, so that a wrong effect can lower the
error in free run below that of the true model, as a dead band does that hides the small moves of OP. But no
effect that is not there lowers the innovations (Ljung, System Identification, 2nd ed., 13.4), but for chance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from agent.identify.noise.autoregression import innovations
from agent.physics.effects.hysteresis import HysteresisEffect
from agent.physics.effects.sinusoid import Sinusoid
from agent.workbench.fit import SCAN, residual_of
from agent.workbench.innovations import by_chance, likelihood_ratio
from agent.workbench.library import acts_on_op, happens_once, instants
from agent.workbench.price import price_of_a_valve
from agent.workbench.residual.very_strong import VERY_STRONG, odds_of
from agent.workbench.space import space_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.identify.noise.autoregression import Innovations
    from agent.physics.effect import Effect
    from agent.workbench.fit import Fit
    from agent.workbench.predictor import Predictor
    from agent.workbench.record import Record


class ModelAtBest(Protocol):
    """A model where it is best."""

    @property
    def fit(self) -> Fit:
        """With the least error in free run."""

    @property
    def predicts(self) -> tuple[Predictor, FloatArray] | None:
        """Where it predicts best; None where it has no predictions."""


VALVES = 16000
"""That a search for a sticking valve looks at, in round numbers: each counts as a try."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What the innovations say of an effect."""

    by_chance: float
    """How likely they fall as far where nothing is missing."""
    criterion: float
    """How much likelier the record is with it, twice a logarithm: by Schwarz, or of a valve that sticks by
    Laplace, where that is more."""
    odds: float
    """The same, with each effect that was scored as likely before as any other."""
    family: str
    """Of the effect."""
    answers: bool
    """Whether it acts on OP, so that it can answer to whatever OP answers to."""
    once: bool
    """Whether it happened at an instant."""
    blind: bool = True
    """Whether the blocks that a fit did not see show it. Not where it happened once: refits know when. Nor a
    load that knows nothing of OP and is no wave, measured or not: slow noise goes along with whatever is
    slow, in all blocks (C. Granger and P. Newbold, "Spurious regressions in econometrics", 1974)."""

    @property
    def plain(self) -> bool:
        """Whether it is very strongly supported."""
        return self.odds > VERY_STRONG


def evidence_of(smaller: ModelAtBest, larger: ModelAtBest, record: Record, candidates: int) -> Evidence:
    """Return what the innovations say of the last effect, each model where it predicts best.

    At the values of the free run the larger model may be the one that answers to the disturbance, and the
    true effect not yet what it is. All numbers are paid; what happened once pays twice for instants.

    Args:
        smaller: The model without the effect.
        larger: The model with it.
        record: What they were fitted to.
        candidates: How many effects were tried on the smaller one, with those that were only scored.
    """
    effect = larger.fit.model.effects[-1]
    answers, once = acts_on_op(effect, record.facts), happens_once(effect, record.facts)
    blind = not once and (answers or isinstance(effect, Sinusoid))
    before, after = (_least_innovations(each, record) for each in (smaller, larger))
    if before is None or after is None:
        return Evidence(1.0, 0.0, 0.0, effect.family, answers, once, blind)
    ratio = likelihood_ratio(before, after, _rounding(larger))
    criterion = _criterion(ratio, before, _priced(smaller, larger, record))
    if smaller.predicts and larger.predicts:
        criterion = max(criterion, ratio - price_of_a_valve(effect, smaller.predicts, larger.predicts))
    odds, chance = odds_of(criterion, candidates), 1.0
    # Thirty lags do not quite whiten a load as slow as a slow wave, so that the latter must be plainer.
    if answers or not blind or odds > VERY_STRONG:
        added = _numbers(larger, record) - _numbers(smaller, record)
        chance = by_chance(ratio, added, candidates * _scanned(effect, record))
    return Evidence(chance, criterion, odds, effect.family, answers, once, blind)


def _scanned(effect: Effect, record: Record) -> int:
    """Return how many values of an effect were looked at.

    Each instant is searched over the whole record; a wave may be at each line of the spectrum.
    """
    if isinstance(effect, HysteresisEffect):
        return VALVES
    if isinstance(effect, Sinusoid):
        return len(record)
    return int(SCAN ** max(1, instants(effect, record.facts)))


def criterion_of(smaller: ModelAtBest, larger: ModelAtBest, record: Record) -> float:
    """Return how much likelier a record is with a larger model, twice a logarithm, by Schwarz's criterion.

    Each where it predicts best; minus infinity where that is not known.
    """
    before, after = (_least_innovations(each, record) for each in (smaller, larger))
    if before is None or after is None:
        return -math.inf
    ratio = likelihood_ratio(before, after, _rounding(larger))
    return _criterion(ratio, before, _priced(smaller, larger, record))


def far_likelier(smaller: ModelAtBest, larger: ModelAtBest, record: Record) -> bool:
    """Return whether the record is very much likelier with a larger model, each where it predicts best."""
    return criterion_of(smaller, larger, record) > VERY_STRONG


def _criterion(ratio: float, before: Innovations, priced: int) -> float:
    return ratio - priced * math.log(np.count_nonzero(np.isfinite(before.values)))


def _rounding(model: ModelAtBest) -> float:
    """Return the mean square below which innovations are rounding, PV units squared."""
    return model.predicts[0].rounding if model.predicts else 0.0


def _priced(smaller: ModelAtBest, larger: ModelAtBest, record: Record) -> int:
    """Return how often more a larger model pays the logarithm of the number of samples.

    Once for each number, and once more for each instant: a record shows an instant to a sample of all, where
    it shows any other number to one over the root of them (N. R. Zhang and D. O. Siegmund, "A modified Bayes
    information criterion", Biometrics 63, 2007).
    """
    one, other = (
        _numbers(each, record) + sum(instants(effect, record.facts) for effect in each.fit.model.effects)
        for each in (smaller, larger)
    )
    return other - one


def _numbers(model: ModelAtBest, record: Record) -> int:
    return _searched(model, record) + len(model.fit.coefficients)


def _searched(model: ModelAtBest, record: Record) -> int:
    return space_of(model.fit.model, record.facts).searched


def _least_innovations(model: ModelAtBest, record: Record) -> Innovations | None:
    """Return the innovations where a model predicts best."""
    if model.predicts is None:
        return innovations(residual_of(model.fit, record))
    predicts, best = model.predicts
    return innovations(predicts.left(best), longest=True)
