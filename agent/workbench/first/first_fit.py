"""The first fit of an effect: from where the smaller model predicts best, by slopes alone.

From the best of many values of the effect, all free: first behind the autoregression of the smaller model,
then behind its own. The former has learnt what the effect does: with it a dead band of twice a logarithm of
35 seems to be worth -31 (``stiction`` 91127). A score says to first order whether the innovations go along
with an effect, which may act in its own direction only; this says whether they do with the effect itself, at
a small part of what the whole search takes. The smaller model is nested in the larger one, so that from here
a search predicts at least as well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.library import instants
from agent.workbench.predictor import renewed, with_effect
from agent.workbench.price import price_of_a_valve
from agent.workbench.search import best_of, by_slopes, spread_about
from agent.workbench.solved.fewest_steps import NUMBERS_OF_A_STEP, variances_with_fewer

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.identify.noise.autoregression import Innovations
    from agent.physics.effect import Effect
    from agent.workbench.predictor import Predictor

PLACES = 100
"""Values of the effect that are looked at, spread over its ranges, and as often with others of the model."""
KEPT, LEFT = 3, 6
"""Of these and of those, from which slopes are followed. The latter leave the valley in which the model stood
for the effect: for ``sensor_deadband`` 91118, PRBS, the criterion is 502 in place of -8."""
SEEN = 3
"""Of all, those that explain most in free run."""
FOLLOWED, TURNS = 2, 3
"""Of their ends, which are followed behind autoregressions of their own, and how many of these."""
MOVED = (-0.5, 0.3)
"""How far numbers of the model are moved, parts of a range: part of its dead time may be the new effect's."""


@dataclass(frozen=True, slots=True)
class FirstFit:
    """Where it ends."""

    values: FloatArray
    """Of the larger model, own units, (k + j,)."""
    criterion: float
    """How much likelier the record is, twice a logarithm, its numbers paid as ``evidence_of`` does: of a load
    with as few steps as are worth it."""
    noise: Innovations
    """The autoregression behind which it is that: behind another its gain, and so the valley, is another."""


def first_fit(
    predicts: Predictor, best: FloatArray, effect: Effect, also: FloatArray | None = None
) -> FirstFit:
    """Return the first fit of an effect on top of a model.

    Args:
        predicts: Of the smaller model.
        best: The point of the unit cube where its predictions are best, (k,).
        effect: That is added.
        also: Values of the larger model to begin from besides, own units, (m, k + j); None: there are none.
    """
    record, known = predicts.objective.record, len(best)
    extended = with_effect(predicts, effect)
    free_run, larger, space = extended.objective, extended.behind, extended.space
    new = np.arange(len(space)) >= known
    spread = spread_about(np.concatenate((best, np.zeros(len(space) - known))), new, MOVED, 2 * PLACES)
    kept, moved = spread[:PLACES], spread[PLACES:]
    own = spread[:0] if also is None else space.at(also)
    starts = (*best_of(larger, np.vstack((own, kept)), KEPT), *best_of(larger, moved, LEFT))
    ends = [by_slopes(larger, each) for each in starts]
    seen = best_of(free_run, np.vstack((own, spread)), SEEN)
    ends += [by_slopes(free_run, each) for each in seen]
    found, end = _behind_own_noise(extended, ends)
    count = len(predicts.pv)
    columns = larger.columns(end).shape[1] - predicts.behind.columns(best).shape[1]
    numbers = space.searched - predicts.space.searched + columns + instants(effect, record.facts)
    valve = price_of_a_valve(effect, (predicts, best), (found, end))
    criterion = max(
        count * math.log(predicts.variance(best) / max(variance, np.finfo(float).tiny))
        - min((numbers - fewer * NUMBERS_OF_A_STEP) * math.log(count), valve)
        for fewer, variance in enumerate(variances_with_fewer(found, end))
    )
    return FirstFit(space.values(end), criterion, found.noise)


def _behind_own_noise(predicts: Predictor, ends: list[FloatArray]) -> tuple[Predictor, FloatArray]:
    """Return the predictions of a larger model behind an autoregression of its own, and where they are best.

    Args:
        predicts: Of the larger model, behind the autoregression of the smaller one.
        ends: Points of its unit cube, (k,), of which the best are followed.
    """
    found = [(predicts, end) for end in ends]
    for turn in range(TURNS):
        owned = [each for each in map(_owned, found) if each is not None]
        found = sorted(owned, key=lambda each: each[0].variance(each[1]))[:FOLLOWED] or found[:1]
        if turn < TURNS - 1:
            found = [(own, by_slopes(own.behind, end)) for own, end in found]
    return found[0]


def _owned(found: tuple[Predictor, FloatArray]) -> tuple[Predictor, FloatArray] | None:
    """Return the same point with predictions behind the autoregression of its own free run."""
    predicts, at = found
    own = renewed(predicts, at)
    return None if own is None else (own, at)
