"""Of several instants of one effect the one that moved PV most comes first: the fit gives them no order."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.predictor import Predictor


def largest_first(predicts: Predictor, best: FloatArray) -> FloatArray:
    """Return the same point of the unit cube, (k,), the instants of each effect in order.

    Only of an effect that has a column for each of its instants, as a load that steps several times.
    """
    objective = predicts.objective
    fitted = predicts.fit(best)
    owners = np.array(objective.layout.owners(objective.record.op, fitted.values))
    moved = np.abs(fitted.coefficients) * np.ptp(objective.columns(best), axis=0)
    point = best.copy()
    for effect in fitted.model.effects:
        at = instants_of(predicts, effect.name)
        own = moved[owners == effect.name]
        if len(at) == len(own):
            point[at] = best[at[np.argsort(-own, kind="stable")]]
    return point


def instants_of(predicts: Predictor, effect: str) -> NDArray[np.intp]:
    """Return which coordinates are instants of an effect."""
    space = predicts.space
    pairs = zip(space.names, space.parameters, strict=True)
    return np.flatnonzero([name.startswith(f"{effect}.") and each.instant for name, each in pairs])
