"""Which models a record cannot distinguish from the best of many: the model confidence set.

The errors of a fit are no independent noise: mostly they are slips that a model places some samples beside
the true ones, a few of these decide between two valves, and the best of many models is so by luck as well. So
the squared errors of each model are summed over each period, and periods are drawn with replacement: that
shows how much the errors of any two would differ in other records of the same loop, and how far apart the two
that differ most would be by chance alone. While the worst is farther from another than that, it leaves the
set (P. R. Hansen, A. Lunde and J. M. Nason, Econometrica 79 (2011) 453: the range statistic T_R).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.identify.residuals import residuals

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from agent.identify.arrays import FloatArray, IntArray
    from agent.identify.fitted import Fitted
    from agent.identify.problem import Problem

LEAST_PIECES = 8
"""Into which a record is divided at least, where it has fewer periods: the scatter of fewer is not known."""
REPLICATES = 200
"""Records that are drawn: p is then known to 0.02 at 0.1."""

SAME = 1e-12
"""Variance of the difference of two models over the sum of theirs, up to which they do not differ."""


def p_of_models(models: Sequence[Fitted], problem: Problem) -> FloatArray:
    """Return p of each model: it belongs to the set of level 1 - p, and to no smaller one, (k,).

    The model with the least error has 1.

    Args:
        models: At least one.
        problem: The record.
    """
    squares = np.array([residuals(each.candidate, each.structure, problem) ** 2 for each in models])
    return p_of_losses(losses_of_pieces(squares, round(problem.period / problem.block)))


def losses_of_pieces(squares: FloatArray, period: int) -> FloatArray:
    """Return the sums over pieces of the record of a period, (k, pieces).

    Args:
        squares: Squared errors of each model, (k, m).
        period: Blocks.
    """
    length = max(1, min(period, squares.shape[1] // LEAST_PIECES))
    pieces = squares.shape[1] // length
    sums: FloatArray = squares[:, : pieces * length].reshape(len(squares), pieces, length).sum(axis=2)
    return sums


def p_of_losses(losses: FloatArray) -> FloatArray:
    """Return p of each model from its losses in independent pieces of a record, (k, pieces)."""
    count, pieces = losses.shape
    rng = np.random.default_rng(0)
    drawn = rng.multinomial(pieces, np.full(pieces, 1.0 / pieces), size=REPLICATES) / pieces
    mean = losses.mean(axis=1)
    by_chance = losses @ drawn.T - mean[:, None]
    error = _errors(by_chance)
    worse = (mean[:, None] - mean) / error
    left = np.ones(count, dtype=np.bool_)
    widest, of_model = _widest(by_chance, error, left)
    p, reached = np.ones(count), 0.0
    for _ in range(count - 1):
        most = np.where(left, worse[:, left].max(axis=1), -np.inf)
        worst = int(np.argmax(most))
        reached = max(reached, float(np.mean(widest >= most[worst])))
        p[worst] = reached
        left[worst] = False
        anew = (of_model == worst).any(axis=1)
        widest[anew], of_model[anew] = _widest(by_chance[:, anew], error, left)
    return p


def _errors(by_chance: FloatArray) -> FloatArray:
    """Return the standard error of the difference of each two models, infinite where they do not differ."""
    variance = by_chance @ by_chance.T / by_chance.shape[1]
    own = np.diag(variance)
    squares = own[:, None] + own - 2.0 * variance
    alike = squares <= SAME * (own[:, None] + own)
    return np.sqrt(np.where(alike, np.inf, squares))


def _widest(by_chance: FloatArray, error: FloatArray, left: NDArray[np.bool_]) -> tuple[FloatArray, IntArray]:
    """Return by how many standard errors the two that are farthest apart differ in each replicate, and who.

    Args:
        by_chance: Of each model in each replicate, (k, r).
        error: From ``_errors``, (k, k).
        left: Which models count, (k,).

    Returns:
        (r,) and (r, 2).
    """
    models = np.flatnonzero(left)
    error = error[np.ix_(models, models)]
    widest, pairs = np.zeros(by_chance.shape[1]), np.zeros((by_chance.shape[1], 2), dtype=np.int64)
    for r, values in enumerate(by_chance[models].T):
        apart = (values[:, None] - values) / error
        place = int(np.argmax(apart))
        widest[r] = apart.flat[place]
        pairs[r] = models[list(divmod(place, len(models)))]
    return widest, pairs
