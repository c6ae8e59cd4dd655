"""The first fit of an effect: from where the smaller model predicts best, by slopes alone.

Behind the autoregression of the smaller model, from the best of many values of the effect, all free. A score
says to first order whether the innovations go along with an effect, which may act in its own direction
only; this says whether they do with the effect itself, at a fiftieth of what the whole search takes. The
smaller model is nested in the larger one, so that from here a search predicts at least as well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.library import instants
from agent.workbench.search import best_of, by_slopes, spread_about
from agent.workbench.space import space_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.predictor import Predictor

PLACES = 100
"""Values of the effect that are looked at, spread over its ranges, and as often with others of the model."""
KEPT, LEFT = 3, 6
"""Of these and of those, from which slopes are followed. The latter leave the valley in which the model stood
for the effect: for ``sensor_deadband`` 91118, PRBS, the criterion is 502 in place of -8."""
MOVED = (-0.5, 0.3)
"""How far numbers of the model are moved, parts of a range: part of its dead time may be the new effect's."""


@dataclass(frozen=True, slots=True)
class FirstFit:
    """Where it ends."""

    values: FloatArray
    """Of the larger model, own units, (k + j,)."""
    criterion: float
    """How much likelier the record is, twice a logarithm, each number paid by Schwarz's criterion."""


def first_fit(predicts: Predictor, best: FloatArray, effect: Effect, also: FloatArray) -> FirstFit:
    """Return the first fit of an effect on top of a model.

    Args:
        predicts: Of the smaller model.
        best: The point of the unit cube where its predictions are best, (k,).
        effect: That is added.
        also: Values of the effect to begin from besides, own units, (m, j).
    """
    record, known = predicts.objective.record, len(best)
    model = predicts.objective.model
    model = replace(model, effects=(*model.effects, effect))
    space = space_of(model, record.facts)
    larger = replace(predicts.behind, model=model, layout=model.layout(record.facts), space=space)
    new = np.arange(len(space)) >= known
    spread = spread_about(np.concatenate((best, np.zeros(len(space) - known))), new, MOVED, 2 * PLACES)
    kept, moved = spread[:PLACES], spread[PLACES:]
    if len(also):
        values = np.hstack((np.tile(predicts.space.values(best), (len(also), 1)), also))
        kept = np.vstack((space.at(values), kept))
    starts = (*best_of(larger, kept, KEPT), *best_of(larger, moved, LEFT))
    end = min((by_slopes(larger, each) for each in starts), key=larger.error)
    count = len(predicts.pv)
    columns = larger.columns(end).shape[1] - predicts.behind.columns(best).shape[1]
    numbers = len(space) - known + columns + instants(effect, record.facts)
    likelier = count * math.log(predicts.error(best) / max(larger.error(end), np.finfo(float).tiny))
    return FirstFit(space.values(end), likelier - numbers * math.log(count))
