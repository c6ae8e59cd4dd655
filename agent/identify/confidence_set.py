"""Which models a record cannot distinguish from the best of many: those that pass a reality check.

The errors of a fit are no independent noise: mostly they are slips that a model places some samples beside
the true ones, a few of these decide between two valves, and the best of many models is so by luck as well. So
the squared errors of each model are summed over each period, and periods are drawn with replacement: that
shows how much the errors of any two would differ in other records of the same loop. A model is rejected where
another is better by more standard errors than the luckiest of all would be better than it by chance alone
(H. White, Econometrica 68 (2000) 1097, in standard errors as P. R. Hansen, J. Business & Economic Statistics
23 (2005) 365, has it).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.identify.residuals import residuals

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.arrays import FloatArray
    from agent.identify.fitted import Fitted
    from agent.identify.problem import Problem

LEAST_PIECES = 8
"""Into which a record is divided at least, where it has fewer periods: the scatter of fewer is not known."""
REPLICATES = 200
"""Records that are drawn: p is then known to 0.02 at 0.1."""

SAME = 1e-12
"""Variance of the difference of two models over the sum of theirs, up to which they do not differ."""


def p_of_models(models: Sequence[Fitted], problem: Problem) -> FloatArray:
    """Return p of each model: the chance that another is as much better than it by luck, (k,).

    The model with the least error has 1.

    Args:
        models: At least one.
        problem: The record.
    """
    squares = np.array([residuals(each.candidate, each.structure, problem) ** 2 for each in models])
    return p_of_losses(sums_of_pieces(squares, round(problem.period / problem.block)))


def sums_of_pieces(values: FloatArray, period: int) -> FloatArray:
    """Return the sums over pieces of the record of a period, (k, pieces).

    Args:
        values: Of each block, such as squared errors of each model, (k, m).
        period: Blocks.
    """
    length = max(1, min(period, values.shape[1] // LEAST_PIECES))
    pieces = values.shape[1] // length
    sums: FloatArray = values[:, : pieces * length].reshape(len(values), pieces, length).sum(axis=2)
    return sums


def p_of_losses(losses: FloatArray) -> FloatArray:
    """Return p of each model from its losses in independent pieces of a record, (k, pieces)."""
    pieces = losses.shape[1]
    rng = np.random.default_rng(0)
    drawn = rng.multinomial(pieces, np.full(pieces, 1.0 / pieces), size=REPLICATES) / pieces
    mean = losses.mean(axis=1)
    by_chance = losses @ drawn.T - mean[:, None]
    error = _errors(by_chance)
    p = np.empty(len(losses))
    for i, of_this in enumerate(error):
        worse = np.max((mean[i] - mean) / of_this)
        luck = np.max((by_chance[i] - by_chance) / of_this[:, None], axis=0)
        p[i] = np.mean(luck >= worse) if worse > 0.0 else 1.0
    return p


def _errors(by_chance: FloatArray) -> FloatArray:
    """Return the standard error of the difference of each two models, infinite where they do not differ."""
    variance = by_chance @ by_chance.T / by_chance.shape[1]
    own = np.diag(variance)
    squares = own[:, None] + own - 2.0 * variance
    alike = squares <= SAME * (own[:, None] + own)
    return np.sqrt(np.where(alike, np.inf, squares))
