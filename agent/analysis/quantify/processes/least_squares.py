"""Ordinary least squares of the three process structures behind many valves, one compiled function each.

Each returns a1, a2, b1, b2 and bias of ``Arx``, shape (5, k), for the k columns of ``mv``. The valves stand
side by side because the sums of one alone keep the processor waiting for the last one. All follow one OP, so
that their positions are missing in the same rows. Rows with a missing sample are left out. Where the normal
equations have no solution (a valve that never moves, too few rows) a1 is NaN.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

SMALLEST_PIVOT = 1e-10
"""Share of a regressor's energy that must not be explained by the others."""


@kernel
def fit_integrator(mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int) -> NDArray[np.float64]:
    """Fit y(t) - y(t-1) = b1 x(t-D) + bias; ``mv`` (n, k) in OP units and ``pv`` (n,) in PV units.

    Slopes are detrended like everything else in the paper, hence the bias: the mean valve position is seldom
    the one that keeps the level.
    """
    k = mv.shape[1]
    rows = 0
    dy_sum = 0.0
    x_sum, xx, xdy = np.zeros(k), np.zeros(k), np.zeros(k)
    for t in range(delay + 1, pv.size):
        x, dy = mv[t - delay], pv[t] - pv[t - 1]
        if np.isnan(dy + x[0]):
            continue
        rows += 1
        dy_sum += dy
        for i in range(k):
            x_sum[i] += x[i]
            xx[i] += x[i] * x[i]
            xdy[i] += x[i] * dy
    coefficients = np.zeros((5, k))
    for i in range(k):
        spread = rows * xx[i] - x_sum[i] * x_sum[i]
        if spread > SMALLEST_PIVOT * rows * xx[i]:
            b1 = (rows * xdy[i] - x_sum[i] * dy_sum) / spread
            coefficients[0, i] = 1.0
            coefficients[2, i] = b1
            coefficients[4, i] = (dy_sum - b1 * x_sum[i]) / rows
        else:
            coefficients[:, i] = np.nan
    return coefficients


@kernel
def fit_first_order(mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int) -> NDArray[np.float64]:
    """Fit y(t) = a1 y(t-1) + b1 x(t-D); ``mv`` (n, k) and ``pv`` (n,) about their means, OP and PV units."""
    k = mv.shape[1]
    yy = yz = 0.0
    xy, xx, xz = np.zeros(k), np.zeros(k), np.zeros(k)
    for t in range(delay + 1, pv.size):
        y, x, z = pv[t - 1], mv[t - delay], pv[t]
        if np.isnan(y + z + x[0]):
            continue
        yy += y * y
        yz += y * z
        for i in range(k):
            xy[i] += x[i] * y
            xx[i] += x[i] * x[i]
            xz[i] += x[i] * z
    coefficients = np.zeros((5, k))
    for i in range(k):
        determinant = yy * xx[i] - xy[i] * xy[i]
        if determinant > SMALLEST_PIVOT * yy * xx[i]:
            coefficients[0, i] = (yz * xx[i] - xz[i] * xy[i]) / determinant
            coefficients[2, i] = (xz[i] * yy - yz * xy[i]) / determinant
        else:
            coefficients[:, i] = np.nan
    return coefficients


@kernel
def fit_second_order(mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int) -> NDArray[np.float64]:
    """Fit y(t) = a1 y(t-1) + a2 y(t-2) + b1 x(t-D) + b2 x(t-D-1).

    ``mv`` (n, k) and ``pv`` (n,) about their means, OP and PV units.
    """
    k = mv.shape[1]
    m00 = m01 = m11 = r0 = r1 = 0.0
    # An array to each sum: one of all of them costs the compiled loop its vector instructions.
    m02, m03, m12, m13 = np.zeros(k), np.zeros(k), np.zeros(k), np.zeros(k)
    m22, m23, m33, r2, r3 = np.zeros(k), np.zeros(k), np.zeros(k), np.zeros(k), np.zeros(k)
    for t in range(delay + 1, pv.size):
        y1, y2, z = pv[t - 1], pv[t - 2], pv[t]
        x1, x2 = mv[t - delay], mv[t - delay - 1]
        if np.isnan(y1 + y2 + z + x1[0] + x2[0]):
            continue
        m00 += y1 * y1
        m01 += y1 * y2
        m11 += y2 * y2
        r0 += y1 * z
        r1 += y2 * z
        for i in range(k):
            a, b = x1[i], x2[i]
            m02[i] += y1 * a
            m03[i] += y1 * b
            m12[i] += y2 * a
            m13[i] += y2 * b
            m22[i] += a * a
            m23[i] += a * b
            m33[i] += b * b
            r2[i] += a * z
            r3[i] += b * z
    coefficients = np.zeros((5, k))
    normal = np.empty((4, 4))
    for i in range(k):
        normal[0] = (m00, m01, m02[i], m03[i])
        normal[1] = (m01, m11, m12[i], m13[i])
        normal[2] = (m02[i], m12[i], m22[i], m23[i])
        normal[3] = (m03[i], m13[i], m23[i], m33[i])
        coefficients[:4, i] = solve_normal_equations(normal, np.array([r0, r1, r2[i], r3[i]]))
    return coefficients


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
