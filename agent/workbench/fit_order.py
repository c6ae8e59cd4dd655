"""Numbers of a model that may change places come in one order, for a fit gives them none.

Of several instants of one effect the one that moved PV most comes first; of lags of the process in series the
longest, so that a lag that is added to a process is the shorter one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.predictor import Predictor
    from agent.workbench.space import Space


LAGS = ("tau", "tau2", "second_order.tau")
"""Of the process, in series: the response is the same in whichever order they are."""


def largest_first(predicts: Predictor, best: FloatArray) -> FloatArray:
    """Return the same model at a point of the unit cube, (k,), instants and lags in order."""
    return lags_in_order(predicts.space, _instants_in_order(predicts, best))


def lags_in_order(space: Space, best: FloatArray) -> FloatArray:
    """Return a point of the unit cube, (k,), with the longest lag first, if the bounds of each allow that."""
    at = [space.names.index(name) for name in LAGS if name in space.names]
    values = space.values(best)
    ordered = np.sort(values[at])[::-1]
    ends = [(space.parameters[i].low, space.parameters[i].high) for i in at]
    allowed = all(low <= each <= high for each, (low, high) in zip(ordered.tolist(), ends, strict=True))
    if not allowed or np.array_equal(ordered, values[at]):
        return best
    values[at] = ordered
    point = best.copy()
    point[at] = space.at(values)[at]
    return point


def lags_alike(space: Space) -> tuple[int, ...]:
    """Return which coordinates are lags in series with one range, the longest first."""
    at = [space.names.index(name) for name in LAGS if name in space.names]
    return tuple(i for i in at if space.parameters[i].low == space.parameters[at[0]].low)


def _instants_in_order(predicts: Predictor, best: FloatArray) -> FloatArray:
    """Return the point with the instants of each effect in order.

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
