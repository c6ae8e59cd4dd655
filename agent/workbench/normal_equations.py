"""Least squares of a few columns from the sums of their products alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agent.jit import kernel

FloatArray = NDArray[np.float64]


@kernel
def coefficients_and_lowered(
    products: FloatArray, gram: FloatArray, along: FloatArray, first: int, vanishes: float
) -> tuple[FloatArray, float]:
    """Return the coefficient of each column, (k,), and by how much all lower the squares of the values.

    Compiled, for it is called hundreds of thousands of times, and numpy takes longer to be called than to
    reckon.

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
