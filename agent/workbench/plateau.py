"""How far a parameter of friction can be moved before the record objects: a profile over its neighbourhood.

The error over S and J is a needle beside others. Refits of the folds begin in the one that the whole record
chose and stay there, so that their scatter alone is too small. Here one parameter is moved outward step by
step, all others refitted, until the squared innovations of the stretches are clearly above those of the best:
an interval by inversion of a paired test.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from agent.workbench.paired_blocks import CONFIDENCE, stretches
from agent.workbench.search import lowered_by_simplex

if TYPE_CHECKING:
    from collections.abc import Callable

    from agent.analysis.recording import FloatArray
    from agent.workbench.predictor import Predictor

OUTWARD = (0.003, 0.01, 0.02, 0.04, 0.07, 0.11, 0.16, 0.24, 0.35, 0.5, 0.7, 1.0)
"""Distances from the best that are tried, parts of the parameter's range."""
EVALUATIONS = 25
"""Of the refit at each, for each parameter that moves."""
STEP = 0.02
"""First step of that refit, parts of a parameter's range."""
BLOCKS = 28
"""Into which the record is cut."""


def plateau(predicts: Predictor, best: FloatArray, at: int) -> tuple[float, float]:
    """Return the least and the largest coordinate ``at`` that the record cannot tell from the best one.

    Of the unit cube, like ``best``, (k,), the point where the predictions are best.
    """
    losses = _losses(predicts, best)
    return _moved_outward(predicts, best, at, lambda point: _alike(_losses(predicts, point), losses))


def instant_plateau(predicts: Predictor, best: FloatArray, at: int) -> tuple[float, float]:
    """Return the same for an instant: by the likelihood of all innovations, white as they are.

    Of what happened once most stretches know nothing. Twice the logarithm of the ratio is at most x with a
    probability of (1 - exp(-x / 2))^2, that of a walk to either side (D. Siegmund, Confidence sets in
    change-point problems, Int. Stat. Rev. 56 (1988) 31), not that of chi-squared.
    """
    most = predicts.error(best) * np.exp(-2 * np.log(1 - np.sqrt(CONFIDENCE)) / len(predicts.pv))
    return _moved_outward(predicts, best, at, lambda point: predicts.error(point) <= most)


def _moved_outward(
    predicts: Predictor, best: FloatArray, at: int, alike: Callable[[FloatArray], bool]
) -> tuple[float, float]:
    """Return the coordinates as far from the best one as points go that are ``alike``."""
    ends = []
    for side in (-1.0, 1.0):
        point, end = best, float(best[at])
        for distance in OUTWARD:
            place = min(max(best[at] + side * distance, 0.0), 1.0)
            point = _refitted(predicts, point, at, place)
            if not alike(point):
                break
            end = place
            if place in (0.0, 1.0):
                break
        ends.append(end)
    return ends[0], ends[1]


def _refitted(predicts: Predictor, start: FloatArray, at: int, place: float) -> FloatArray:
    """Return the best point near ``start`` whose coordinate ``at`` is at ``place``."""
    moves = np.arange(len(start)) != at
    point = start.copy()
    point[at] = place

    def error(others: FloatArray) -> float:
        point[moves] = others
        return predicts.error(point)

    point[moves] = lowered_by_simplex(error, start[moves], STEP, EVALUATIONS, near=1e-4, flat=0.0)
    return point


def _losses(predicts: Predictor, point: FloatArray) -> FloatArray:
    squares = predicts.residual(point) ** 2
    return stretches(np.array([part.sum() for part in np.array_split(squares, BLOCKS)]))


def _alike(losses: FloatArray, best: FloatArray) -> bool:
    """Whether the losses (s,) of a model are not clearly above the best one's, (s,).

    Where the loss is smooth its rise goes with the square of the distance and its scatter with the distance,
    so that half the quantile bounds the usual interval.
    """
    rise = losses - best
    count = len(rise)
    scatter = float(np.std(rise, ddof=1)) / np.sqrt(count)
    quantile = float(stats.t.ppf(0.5 + CONFIDENCE / 2, count - 1))
    return bool(rise.mean() <= 0.5 * quantile * scatter)
