"""Nelder and Mead's search within the unit cube: where an error has steps or kinks.

scipy's, step by step, at a fifth of what that costs beside the errors: an error takes a tenth of a
millisecond, and scipy as long around it.
Source: J. Nelder and R. Mead, The Computer Journal 7 (1965) 308, with the usual coefficients (reflection 1,
expansion 2, contraction and shrinkage 1/2); points that leave the cube are moved to its wall.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from agent.analysis.record.recording import FloatArray


def lowered_by_simplex(
    errors_at: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    step: float,
    evaluations: int,
    *,
    near: float,
    flat: float,
    enough: float = -np.inf,
) -> FloatArray:
    """Return the best point of the unit cube that the search finds from ``start`` (k,), k >= 1.

    Args:
        errors_at: What is lowered, of points, (m, k), (m,).
        start: Where it begins.
        step: To the first corners, inward where it would leave the cube.
        evaluations: For each coordinate, at most.
        near: It ends where the corners are as near to each other as this,
        flat: and their errors, in the unit of ``error``,
        enough: or where an error is as low as this.
    """
    count = len(start)
    left = evaluations * count
    corners = np.vstack((start, start + np.diag(np.where(start + step > 1.0, -step, step))))
    errors = errors_at(corners[:left])
    corners = corners[: len(errors)]
    left -= len(errors)
    corners, errors = _sorted(corners, errors)

    def error(point: FloatArray) -> float:
        return float(errors_at(point[np.newaxis])[0])

    while left > 0 and len(errors) > count and errors[0] > enough:
        if np.abs(corners[1:] - corners[0]).max() <= near and errors[-1] - errors[0] <= flat:
            break
        middle = np.add.reduce(corners[:-1], 0) / count
        worst = corners[-1].copy()
        reflected = _inside(2.0 * middle - worst)
        there = error(reflected)
        left -= 1
        corners[-1], found = reflected, there
        if there < errors[0]:
            if left == 0:
                corners[-1], found = worst, errors[-1]
            else:
                expanded = _inside(3.0 * middle - 2.0 * worst)
                further = error(expanded)
                left -= 1
                if further < there:
                    corners[-1], found = expanded, further
        elif there >= errors[-2]:
            corners[-1], found = worst, errors[-1]
            if left > 0:
                outside = there < errors[-1]
                contracted = _inside(1.5 * middle - 0.5 * worst if outside else 0.5 * middle + 0.5 * worst)
                nearer = error(contracted)
                left -= 1
                if nearer <= there if outside else nearer < errors[-1]:
                    corners[-1], found = contracted, nearer
                else:
                    left = _shrink(errors_at, corners, errors, left)
                    found = errors[-1]
        errors[-1] = found
        corners, errors = _sorted(corners, errors)
    return np.asarray(corners[0], dtype=np.float64)


def _shrink(
    errors_at: Callable[[FloatArray], FloatArray], corners: FloatArray, errors: FloatArray, left: int
) -> int:
    """Halve the way of all corners to the first within ``left`` evaluations; return how many remain."""
    moved = slice(1, left + 1)
    corners[moved] = _inside(corners[0] + 0.5 * (corners[moved] - corners[0]))
    errors[moved] = errors_at(corners[moved])
    return max(left - len(corners) + 1, 0)


def _inside(point: FloatArray) -> FloatArray:
    return np.minimum(np.maximum(point, 0.0), 1.0)


def _sorted(corners: FloatArray, errors: FloatArray) -> tuple[FloatArray, FloatArray]:
    order = np.argsort(errors)
    return corners[order], errors[order]
