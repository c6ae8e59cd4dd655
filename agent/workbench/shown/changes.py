"""What an effect would add to PV at many of its values, all of the model kept: nothing is fitted."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.search import hypercube
from agent.workbench.space import space_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.predictor import Predictor

PLACES = 60
"""Values of an effect that are looked at, spread over its ranges."""


def changes(
    predicts: Predictor, best: FloatArray, effect: Effect, also: Iterable[FloatArray] = ()
) -> Iterator[FloatArray]:
    """Yield what an effect adds, each (n, k): its columns of a disturbance, else for a gain of one.

    Args:
        predicts: Of the model without the effect.
        best: The point of the unit cube where its predictions are best, (k,).
        effect: That could be added.
        also: Values to look at besides, own units, each (j,).
    """
    objective = predicts.objective
    record = objective.record
    model = replace(objective.model, effects=(*objective.model.effects, effect))
    space, layout = space_of(model, record.facts), model.layout(record.facts)
    values, before = objective.space.values(best), objective.columns(best)
    points = hypercube(PLACES, len(space) - len(values))
    spread = (space.values(np.concatenate((best, each)))[len(values) :] for each in points)
    for own in (*spread, *also):
        columns = layout.columns(record.op, np.concatenate((values, own)))
        if effect.stage == "disturbance":
            yield columns[:, before.shape[1] :]
        else:
            yield columns[:, :1] - before[:, :1]
