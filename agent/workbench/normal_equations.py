"""Least squares of a few columns beside a nuisance, from the sums of their products.

Compiled, for they are called hundreds of thousands of times, and numpy takes longer to be called than to
reckon.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agent.jit import kernel, summing_kernel

FloatArray = NDArray[np.float64]


@kernel
def coefficients_and_lowered(
    products: FloatArray, gram: FloatArray, along: FloatArray, first: int, vanishes: float
) -> tuple[FloatArray, float]:
    """Return the coefficient of each column, (k,), and by how much all lower the squares of the values.

    Args:
        products: Of the columns, (k, k).
        gram: The same less what the nuisance explains of them.
        along: Products of columns and values, (k,).
        first: Columns before this one get zero.
        vanishes: A column with no more than this part of its squares left gets zero; as a ridge on columns of
            length one it shares between those that are the same.
    """
    count = len(along)
    there = np.zeros(count, dtype=np.int64)
    left = 0
    for i in range(first, count):
        if gram[i, i] > vanishes * products[i, i]:
            there[left] = i
            left += 1
    coefficients = np.zeros(count)
    if left == 0:
        return coefficients, 0.0
    lengths, unit = np.empty(left), np.empty(left)
    for i in range(left):
        lengths[i] = np.sqrt(gram[there[i], there[i]])
        unit[i] = along[there[i]] / lengths[i]
    scaled = np.empty((left, left))
    for i in range(left):
        for k in range(left):
            scaled[i, k] = gram[there[i], there[k]] / (lengths[i] * lengths[k])
        if left > 1:
            scaled[i, i] += vanishes
    found = np.linalg.solve(scaled, unit)
    lowered = 0.0
    for i in range(left):
        explained = 0.0
        for k in range(left):
            explained += scaled[i, k] * found[k]
        lowered += found[i] * (2 * unit[i] - explained)
        coefficients[there[i]] = found[i] / lengths[i]
    return coefficients, lowered


@kernel
def lowered_by(
    columns: FloatArray,
    weight: FloatArray,
    basis: FloatArray,
    pv: FloatArray,
    gain_sign: int,
    vanishes: float,
) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Return columns where PV counts, (k, n), their products with the nuisance, (q, k), coefficients, (k,).

    And by how much the columns lower the squares of PV: right to about 1e-12 of these; minus infinity, and
    coefficients of zero, where a column is not finite.

    Args:
        columns: (k, n), the response first.
        weight: 1 or 0, (n,).
        basis: Orthonormal rows of the nuisance where PV counts, (q, n).
        pv: The nuisance projected out, (n,).
        gain_sign: Of the response; 0: any. One of the other sign is none.
        vanishes: As in ``coefficients_and_lowered``.
    """
    free, outside, products, along = sums_of_products(columns, weight, basis, pv)
    gram = products.copy()
    finite = True
    for i in range(len(gram)):
        for k in range(len(gram)):
            for j in range(len(basis)):
                gram[i, k] -= outside[j, i] * outside[j, k]
            finite = finite and np.isfinite(gram[i, k])
    if not finite:
        return free, outside, np.zeros(len(gram)), -np.inf
    coefficients, lowered = coefficients_and_lowered(products, gram, along, 0, vanishes)
    if coefficients[0] * gain_sign < 0:
        coefficients, lowered = coefficients_and_lowered(products, gram, along, 1, vanishes)
    return free, outside, coefficients, lowered


@summing_kernel
def sums_of_products(
    columns: FloatArray, weight: FloatArray, basis: FloatArray, pv: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return columns where PV counts, (k, n), and their products with the basis, each other and PV.

    The arguments are those of ``lowered_by``; the products have the shapes (q, k), (k, k) and (k,).
    """
    count, size = columns.shape
    free = np.empty((count, size))
    outside, products, along = np.empty((len(basis), count)), np.empty((count, count)), np.empty(count)
    for i in range(count):
        own = free[i]
        for t in range(size):
            own[t] = columns[i, t] * weight[t]
        along[i] = product(own, pv)
        for j in range(len(basis)):
            outside[j, i] = product(own, basis[j])
        for k in range(i + 1):
            products[i, k] = products[k, i] = product(own, free[k])
    return free, outside, products, along


@summing_kernel
def product(one: FloatArray, other: FloatArray) -> float:
    """Return the sum of the products of two series, (n,)."""
    total = 0.0
    for t in range(len(one)):
        total += one[t] * other[t]
    return total


@kernel
def left_of(
    pv: FloatArray, free: FloatArray, coefficients: FloatArray, basis: FloatArray, outside: FloatArray
) -> FloatArray:
    """Return PV less its best explanation, (n,), of what ``lowered_by`` returns."""
    left = pv.copy()
    for i in range(len(free)):
        own, amount = free[i], coefficients[i]
        for t in range(len(left)):
            left[t] -= amount * own[t]
    for j in range(len(basis)):
        row, amount = basis[j], 0.0
        for i in range(len(free)):
            amount += outside[j, i] * coefficients[i]
        for t in range(len(left)):
            left[t] += amount * row[t]
    return left


@kernel
def least_errors(
    rows: FloatArray, weight: FloatArray, basis: FloatArray, pv: FloatArray, gain_sign: int, vanishes: float
) -> FloatArray:
    """Return the squares that many models leave of PV, (m,); infinite where a column is not finite.

    ``rows``: the columns of each, (m, k, n); the others as ``lowered_by`` takes them.
    """
    errors, squares = np.empty(len(rows)), product(pv, pv)
    for i in range(len(rows)):
        errors[i] = max(squares - lowered_by(rows[i], weight, basis, pv, gain_sign, vanishes)[3], 0.0)
    return errors


@kernel
def residuals_behind(
    rows: FloatArray, weight: FloatArray, basis: FloatArray, pv: FloatArray, gain_sign: int, vanishes: float
) -> FloatArray:
    """Return what many models leave of PV, (m, n): PV itself where a column is not finite."""
    left = np.empty((len(rows), len(pv)))
    for i in range(len(rows)):
        free, outside, coefficients, lowered = lowered_by(rows[i], weight, basis, pv, gain_sign, vanishes)
        left[i] = pv if lowered == -np.inf else left_of(pv, free, coefficients, basis, outside)
    return left
