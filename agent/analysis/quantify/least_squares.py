"""Ordinary least squares of the three process structures, one compiled function each.

Rows with a missing sample in them are left out. Where the normal equations have no solution (a valve that
never moves, too few rows) a1 is NaN.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from agent.physics.processes.arx import Arx

if TYPE_CHECKING:
    from numpy.typing import NDArray

SMALLEST_PIVOT = 1e-10
"""Share of a regressor's energy that must not be explained by the others."""


@kernel
def fit_integrator(mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int) -> Arx:
    """Fit y(t) - y(t-1) = b1 x(t-D) + bias; arrays (n,), OP and PV units.

    Slopes are detrended like everything else in the paper, hence the bias: the mean valve position is seldom
    the one that keeps the level.
    """
    rows = 0
    x_sum = dy_sum = xx = xdy = 0.0
    for t in range(delay + 1, pv.size):
        x, dy = mv[t - delay], pv[t] - pv[t - 1]
        if np.isnan(x + dy):
            continue
        rows += 1
        x_sum += x
        dy_sum += dy
        xx += x * x
        xdy += x * dy
    spread = rows * xx - x_sum * x_sum
    if not spread > SMALLEST_PIVOT * rows * xx:
        return Arx(np.nan, 0.0, np.nan, 0.0, np.nan, delay)
    b1 = (rows * xdy - x_sum * dy_sum) / spread
    return Arx(1.0, 0.0, b1, 0.0, (dy_sum - b1 * x_sum) / rows, delay)


@kernel
def fit_first_order(mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int) -> Arx:
    """Fit y(t) = a1 y(t-1) + b1 x(t-D); arrays (n,), OP and PV units, both about their means."""
    yy = xy = xx = yz = xz = 0.0
    for t in range(delay + 1, pv.size):
        y, x, z = pv[t - 1], mv[t - delay], pv[t]
        if np.isnan(y + x + z):
            continue
        yy += y * y
        xy += x * y
        xx += x * x
        yz += y * z
        xz += x * z
    determinant = yy * xx - xy * xy
    if not determinant > SMALLEST_PIVOT * yy * xx:
        return Arx(np.nan, 0.0, np.nan, 0.0, 0.0, delay)
    a1 = (yz * xx - xz * xy) / determinant
    b1 = (xz * yy - yz * xy) / determinant
    return Arx(a1, 0.0, b1, 0.0, 0.0, delay)


@kernel
def fit_second_order(mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int) -> Arx:
    """Fit y(t) = a1 y(t-1) + a2 y(t-2) + b1 x(t-D) + b2 x(t-D-1).

    Arrays (n,), OP and PV units, both about their means.
    """
    # Scalars, since a loop over the columns of a row costs the compiled code four times as much.
    m00 = m01 = m02 = m03 = m11 = m12 = m13 = m22 = m23 = m33 = 0.0
    r0 = r1 = r2 = r3 = 0.0
    for t in range(delay + 1, pv.size):
        y1, y2, x1, x2, z = pv[t - 1], pv[t - 2], mv[t - delay], mv[t - delay - 1], pv[t]
        if np.isnan(y1 + y2 + x1 + x2 + z):
            continue
        m00 += y1 * y1
        m01 += y1 * y2
        m02 += y1 * x1
        m03 += y1 * x2
        m11 += y2 * y2
        m12 += y2 * x1
        m13 += y2 * x2
        m22 += x1 * x1
        m23 += x1 * x2
        m33 += x2 * x2
        r0 += y1 * z
        r1 += y2 * z
        r2 += x1 * z
        r3 += x2 * z
    normal = np.array(
        [[m00, m01, m02, m03], [m01, m11, m12, m13], [m02, m12, m22, m23], [m03, m13, m23, m33]]
    )
    c = solve_normal_equations(normal, np.array([r0, r1, r2, r3]))
    return Arx(c[0], c[1], c[2], c[3], 0.0, delay)


@kernel
def solve_normal_equations(matrix: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    """Solve a symmetric positive definite system, shape (k, k) and (k,); NaN where it is singular.

    Gauss without exchange of rows, which such a matrix doesn't need. LAPACK would raise where this says NaN.
    """
    k = right.size
    upper = matrix.copy()
    solution = right.copy()
    for row in range(k):
        for pivot in range(row):
            factor = upper[row, pivot] / upper[pivot, pivot]
            upper[row, pivot:] -= factor * upper[pivot, pivot:]
            solution[row] -= factor * solution[pivot]
        if not upper[row, row] > SMALLEST_PIVOT * matrix[row, row]:
            return np.full(k, np.nan)
    for row in range(k - 1, -1, -1):
        solution[row] -= np.sum(upper[row, row + 1 :] * solution[row + 1 :])
        solution[row] /= upper[row, row]
    return solution
