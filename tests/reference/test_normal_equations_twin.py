"""The compiled normal equations against numpy's least squares."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from agent.workbench.normal_equations import coefficients_and_lowered

VANISHES = 1e-9


def by_numpy(columns: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, float]:
    coefficients = np.linalg.lstsq(columns, values, rcond=None)[0]
    left = values - columns @ coefficients
    return coefficients, float(values @ values - left @ left)


@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.integers(0, 2))
def test_lowers_what_least_squares_lower(seed: int, count: int, first: int) -> None:
    random = np.random.default_rng(seed)
    columns = random.standard_normal((60, first + count)) * 10.0 ** random.uniform(-3, 3, first + count)
    values = random.standard_normal(60)
    products = columns.T @ columns
    coefficients, lowered = coefficients_and_lowered(products, products, columns.T @ values, first, VANISHES)
    expected, most = by_numpy(columns[:, first:], values)
    assert np.allclose(coefficients[first:], expected, rtol=1e-6)
    assert not coefficients[:first].any()
    assert np.isclose(lowered, most, rtol=1e-6)


def test_what_the_nuisance_explains_gets_nothing() -> None:
    products = np.array([[4.0, 1.0], [1.0, 9.0]])
    gram = np.array([[0.0, 0.0], [0.0, 9.0]])
    coefficients, lowered = coefficients_and_lowered(products, gram, np.array([0.0, 18.0]), 0, VANISHES)
    assert np.allclose(coefficients, [0.0, 2.0])
    assert np.isclose(lowered, 36.0)


def test_none_are_left() -> None:
    products = np.eye(1)
    coefficients, lowered = coefficients_and_lowered(products, products, np.ones(1), 1, VANISHES)
    assert coefficients.tolist() == [0.0]
    assert lowered == 0.0


def test_two_alike_share() -> None:
    products = np.ones((2, 2))
    coefficients, lowered = coefficients_and_lowered(products, products, np.ones(2), 0, VANISHES)
    assert np.allclose(coefficients, 0.5)
    assert np.isclose(lowered, 1.0)
