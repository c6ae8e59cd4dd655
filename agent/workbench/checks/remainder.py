"""What remains with an effect, without a name: whether the innovations still go along with anything of OP.

The true cause need not be in the library. Whatever it is, a wrong effect leaves a part of what the true one
does: of curves of the valve's position or of the response, of slack in either, of further lags, of what
follows large moves otherwise than small ones, or moves up otherwise than moves down, of a valve that needs
time for its travel, of a gain that changes in time. Columns of all of these are added behind the model one
after the other, the best first, each paid by Schwarz's criterion and for being chosen: a matching pursuit
(Mallat and Zhang, IEEE Trans. Signal Process. 41 (1993) 3397) over a score test (Rao 1948). What the model
does by a small change of its own numbers is no remainder, but a number at a bound cannot move. Nothing is
fitted.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.bases.linear_process import lagged
from agent.physics.effects.deadband import backlash
from agent.physics.effects.rate_limit import slewed
from agent.workbench.residual.movable import beyond, movable_inside

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.predictor import Predictor

KNOTS = 9
"""Of a curve, at the deciles of what it depends on."""
BANDS = tuple(np.geomspace(0.01, 1.2, 10).tolist())
"""Widths of slack, over the span of what moves: from hardly seen to more than its moves."""
LAGS = tuple(np.geomspace(0.01, 1.0, 7).tolist())
"""Further time constants, dominant periods."""
TRAVELS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Times in which the valve goes through all of its travel, dominant periods."""
INSTANTS = 10
"""From which on the gain drifts, equally spaced."""
MOST = 4
"""Columns that are added: what is not in the library may need several, a remainder of two effects as well."""
OWN = 1e-4
"""Part of a column's squares that must be beyond the model and the columns before; less is rounding."""


def remainder(predicts: Predictor, best: FloatArray) -> float:
    """Return how much likelier the record is with what has no name beside a model, to first order.

    Twice a logarithm, all that is added paid; 0 where nothing is worth its price.

    Args:
        predicts: Of the model.
        best: The point of the unit cube where its predictions are best, (k,).
    """
    known = movable_inside(predicts, best)
    left = beyond(predicts.residual(best), known)
    variance = max(float(left @ left) / max(len(left) - known.shape[1], 1), predicts.rounding)
    white = predicts.whitened(np.column_stack([*_unnamed(predicts, best)]))
    new, least = beyond(white, known), OWN * np.sum(white**2, axis=0)
    price = math.log(len(left)) + 2 * math.log(white.shape[1])
    found = most = 0.0
    for _ in range(MOST):
        squares = np.sum(new**2, axis=0)
        able = squares > least
        if not able.any():
            break
        gains = np.where(able, (new.T @ left) ** 2 / np.where(able, squares, 1.0), 0.0)
        at = int(np.argmax(gains))
        along = new[:, at] / math.sqrt(squares[at])
        left, new = beyond(left, along[:, np.newaxis]), beyond(new, along[:, np.newaxis])
        found += float(gains[at]) / variance - price
        most = max(most, found)
    return most


def _unnamed(predicts: Predictor, best: FloatArray) -> Iterator[FloatArray]:
    """Yield additional responses of PV, PV units but for a factor, each (n,)."""
    objective = predicts.objective
    record, layout, values = objective.record, objective.layout, objective.space.values(best)
    position = layout.position(record.op, values)
    response = layout.response(position, values)
    speeds = [float(np.ptp(position)) / (time * record.period) for time in TRAVELS]
    moved = np.column_stack([*_bent(position), *(slewed(position, speed) for speed in speeds)])
    yield from layout.answers(position, moved - position[:, np.newaxis], values).T
    yield from _bent(response)
    for lag in LAGS:
        rise = response - lagged(response, lag * record.period)
        yield from (rise, np.abs(rise), rise * np.abs(rise))
    time = np.linspace(0.0, 1.0, len(response))
    for instant in np.arange(INSTANTS) / INSTANTS:
        yield response * np.maximum(time - instant, 0.0)


def _bent(signal: FloatArray) -> Iterator[FloatArray]:
    """Yield what a curve or slack makes of a signal, each (n,)."""
    for knot in np.unique(np.quantile(signal, np.arange(1, KNOTS + 1) / (KNOTS + 1))):
        yield np.maximum(signal - knot, 0.0)
    span = float(np.ptp(signal))
    for band in BANDS:
        yield backlash(signal, band * span, float(signal[0]))
