"""Least squares within the unit cube by the steps of Gauss and Newton, damped by Levenberg and Marquardt.

A coordinate at a bound from which the error falls outward stays there. scipy's trust regions keep inside the
bounds and come near them only, so that a delay of one sample is estimated as 1.03.
Source: J. Nocedal and S. Wright, Numerical Optimization, 2nd ed. (2006), 10.3 and 16.7.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.normal_equations import coefficients_and_lowered

if TYPE_CHECKING:
    from collections.abc import Callable

    from agent.analysis.record.recording import FloatArray

FLAT = 1e-6
"""Part of the error by which a step lowers it at least, where nothing else is given."""
DAMPING, LESS, MORE = 1e-3, 0.1, 10.0
"""The first, over the squares of the derivatives, and what a step that helped, or did not, makes of it."""
LEAST_DAMPING = 1e-9
"""Below which it does not fall: where two coordinates do the same, something must share between them."""
TRIES = 6
"""Dampings of one step."""


def lowest(
    residuals: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    steps: int,
    difference: float,
    flat: float = FLAT,
) -> FloatArray:
    """Return the point of the unit cube, (k,), with the least squares that is found from ``start``.

    Args:
        residuals: Of points, (m, k), each a row, (m, n); not finite where there is none.
        start: Where it begins, (k,).
        steps: At most.
        difference: Of two points for a derivative, part of the cube.
        flat: Part of the error by which a step lowers it at least.
    """
    at, here = start, residuals(start[np.newaxis])[0]
    error, damping = float(here @ here), DAMPING
    for _ in range(steps):
        slopes = _slopes(residuals, at, here, difference)
        along, squares = slopes @ here, slopes @ slopes.T
        if not np.isfinite(squares).all():
            break
        outward = ((at <= 0.0) & (along > 0.0)) | ((at >= 1.0) & (along < 0.0))
        free = np.flatnonzero(~outward & (np.diag(squares) > 0.0))
        before = error
        for _ in range(TRIES):
            damped = squares[np.ix_(free, free)] + damping * np.diag(np.diag(squares)[free])
            moved = at.copy()
            step, _ = coefficients_and_lowered(damped, damped, along[free], 0, LEAST_DAMPING)
            moved[free] = np.clip(at[free] - step, 0.0, 1.0)
            there = residuals(moved[np.newaxis])[0]
            if (lower := float(there @ there)) < error:
                at, here, error, damping = moved, there, lower, damping * LESS
                break
            damping *= MORE
        if error > (1.0 - flat) * before:
            break
    return at


def _slopes(
    residuals: Callable[[FloatArray], FloatArray], at: FloatArray, here: FloatArray, difference: float
) -> FloatArray:
    """Return the derivatives of the residual by the coordinates, (k, n)."""
    moved = np.tile(at, (len(at), 1))
    places = np.where(at + difference <= 1.0, at + difference, at - difference)
    np.fill_diagonal(moved, places)
    return np.asarray((residuals(moved) - here) / (places - at)[:, np.newaxis])
