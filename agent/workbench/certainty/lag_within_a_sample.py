"""What a lag within a sample may have done to the values of a model.

Every valve has one, and a record cannot show it. But a zero, a band or a dead time makes up for it, and the
model without a lag rules out what is there: each of six zeros in PRBS (``simulators.draws.hidden_effects``,
seeds 91545 to 91567) lay outside its interval, by 4 to 18 times half of it. So values are as sure as those
with which the record is as likely beside a lag of up to a sample.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.second_order import SecondOrder
from agent.physics.effects.sensor_lag import SensorLag
from agent.workbench.certainty.free_memory import with_free_memory
from agent.workbench.certainty.likelihood_profile import CLEARLY, refitted
from agent.workbench.library import missing
from agent.workbench.predictor import with_effect

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.predictor import Predictor

ANY_LAG = (SecondOrder(), SensorLag())
"""Effects that may be it: the first that the model does not have."""
LAGS = (0.25, 0.5, 0.75, 1.0)
"""That are tried, samples."""
SOONER = (0.0, 0.5, 1.0)
"""Samples by which the dead time may be less besides: the error has a valley within each sample."""
DELAY = "delay"


def values_beside_a_lag(predicts: Predictor, best: FloatArray) -> FloatArray:
    """Return values with which the record is as likely beside a lag of at most a sample.

    Args:
        predicts: Of a model.
        best: The point of the unit cube where its predictions are best, (k,).

    Returns:
        Points of the same cube, (m, k); none of a process that takes no lag.
    """
    model, ts = predicts.objective.model, predicts.objective.facts.ts
    lag = missing(model, ANY_LAG)[:1]
    if not lag or not model.base.linear or DELAY not in predicts.space.names:
        return np.empty((0, len(best)))
    none = np.append(best, 0.0)
    larger = with_free_memory(with_effect(predicts, *lag), none)
    delay, values = larger.space.names.index(DELAY), larger.space.values(none)
    most = larger.error(none) * float(np.exp(CLEARLY / len(larger.pv)))
    found = []
    for length in LAGS:
        starts = np.tile(values, (len(SOONER), 1))
        starts[:, -1] = length * ts
        starts[:, delay] -= (length + np.array(SOONER)) * ts
        points = np.clip(larger.space.at(starts), 0.0, 1.0)
        start = min(points, key=larger.behind.error)
        point, error = refitted(larger.behind, start, (len(best),), float(start[-1]), most)
        if error <= most:
            found.append(point[:-1])
    return np.array(found).reshape(-1, len(best))
