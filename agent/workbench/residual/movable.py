"""What a model can do by a small change of all its numbers, and what is beyond it.

To first order, behind the filter of the noise: the derivatives by its values, its own columns whose
amounts are solved for, level and drift where they are, and a transient at the start of the record.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.residual.state_dependence import directions, left_of_start
from agent.workbench.space import AT_BOUND

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.predictor import Predictor


def movable(predicts: Predictor, best: FloatArray) -> FloatArray:
    """Return orthonormal columns of what a model may move to, (m, q).

    Args:
        predicts: Of the model.
        best: The point of the unit cube where its predictions are best, (k,).
    """
    return _movable(predicts, best, np.ones(len(best), dtype=np.bool_))


def movable_inside(predicts: Predictor, best: FloatArray) -> FloatArray:
    """Return ``movable`` of a model whose numbers at a bound of their search stay there."""
    return _movable(predicts, best, (best >= AT_BOUND) & (best <= 1 - AT_BOUND))


def _movable(predicts: Predictor, best: FloatArray, free: NDArray[np.bool_]) -> FloatArray:
    own = np.column_stack(
        (predicts.solved_for(predicts.objective.columns(best)), left_of_start(predicts.objective.record))
    )
    white = predicts.noise.filtered(own)[predicts.kept]
    return directions(np.column_stack((predicts.derivative(best)[:, free], white, predicts.basis)))


def beyond(columns: FloatArray, known: FloatArray) -> FloatArray:
    """Return columns, (m,) or (m, k), less what is along ``known``, orthonormal columns (m, q)."""
    return np.asarray(columns - known @ (known.T @ columns), dtype=np.float64)
