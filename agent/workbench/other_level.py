"""Is what happened once another answer to OP, or only another level?

A gain that changes moves the level as well, unless it does so at its pivot. So it does what a load does that
steps, and may be taken for it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.load_step import stepped
from agent.workbench.instant_order import instants_of

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray
    from agent.workbench.predictor import Predictor

LAGS = (0.0, 0.03, 0.06, 0.12, 0.25, 0.5, 1.0)
"""Of the steps, dominant periods."""


def beside_other_level(predicts: Predictor, best: FloatArray) -> float:
    """Return how much likelier the last effect makes the record beside steps of the level at its instants.

    By Schwarz's criterion, twice a logarithm; the steps are of all lags.

    Args:
        predicts: Of a model whose last effect happened once, on a linear base.
        best: The point of the unit cube where its predictions are best, (k,).
    """
    objective, values = predicts.objective, predicts.space.values(best)
    record, effect = objective.record, objective.model.effects[-1]
    time = np.asarray(record.facts.ts * np.arange(len(record)), dtype=np.float64)
    instants = values[instants_of(predicts, effect.name)].tolist()
    steps = [stepped(time, each, lag * record.facts.period) for each in instants for lag in LAGS]
    columns = objective.columns(best)
    last = np.array([owner == effect.name for owner in objective.layout.owners(record.op, values)])
    without = np.column_stack((columns[:, ~last], *steps))
    both = np.column_stack((without, columns[:, last]))
    count = len(predicts.pv)
    ratio = count * math.log(_left(predicts, without) / _left(predicts, both))
    return ratio - int(last.sum()) * math.log(count)


def _left(predicts: Predictor, columns: FloatArray) -> float:
    """Return the squares of the innovations with these columns (n, k) at their best, PV units squared."""
    white = predicts.noise.filtered(columns)[predicts.kept]
    white -= predicts.basis @ (predicts.basis.T @ white)
    left = predicts.pv - white @ np.linalg.lstsq(white, predicts.pv, rcond=None)[0]
    return float(left @ left)
