"""What the numbers of a sticking valve cost: Laplace's price of fitting them.

Most strokes show little of a stem's constants, so that Schwarz's price of seven numbers hides a valve.
Source: D. MacKay, Information Theory, Inference, and Learning Algorithms (2003), 28.1.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.hysteresis import HysteresisEffect

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.predictor import Predictor


def price_of_a_valve(
    effect: Effect, smaller: tuple[Predictor, FloatArray], larger: tuple[Predictor, FloatArray]
) -> float:
    """Return what a valve's numbers cost, twice a logarithm; infinite of other effects, and where not known.

    Args:
        effect: By which the models differ.
        smaller: Predictions without it, and where in the unit cube they are best.
        larger: With it.
    """
    if not isinstance(effect, HysteresisEffect):
        return math.inf
    price = _ruled_out(*larger) - _ruled_out(*smaller)
    return price if math.isfinite(price) else math.inf


def _ruled_out(predicts: Predictor, best: FloatArray) -> float:
    """Return how much of the ranges of its values a record rules out.

    Twice the logarithm of the cube over the Gaussian peak of the likelihood in it, of the directions that the
    record shows. NaN where the model has no answer beside its best.
    """
    derivative = predicts.derivative(best)
    if not np.isfinite(derivative).all():
        return math.nan
    sharpness = np.linalg.eigvalsh(derivative.T @ derivative) / predicts.variance(best)
    return float(np.sum(np.log(np.maximum(sharpness / (2 * np.pi), 1.0))))
