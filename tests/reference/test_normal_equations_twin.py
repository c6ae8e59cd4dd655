"""The compiled normal equations against numpy's least squares."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from agent.workbench.normal_equations import (
    coefficients_and_lowered,
    least_errors,
    lowered_by,
    residuals_behind,
)

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


def posed(seed: int, count: int, *, outside: int = 3) -> tuple[np.ndarray, ...]:
    """Return columns as rows, which samples count, an orthonormal nuisance on these, PV without it."""
    random = np.random.default_rng(seed)
    weight = (random.random(60) < 0.8).astype(float)
    basis = np.linalg.qr(random.standard_normal((60, outside)) * weight[:, None])[0].T
    pv = random.standard_normal(60) * weight
    rows = random.standard_normal((count, 60)) * 10.0 ** random.uniform(-2, 2, (count, 1))
    return rows, weight, np.ascontiguousarray(basis), pv - basis.T @ (basis @ pv)


@given(st.integers(0, 2**32 - 1), st.integers(1, 4), st.sampled_from((-1, 0, 1)))
def test_beside_a_nuisance_and_where_pv_counts(seed: int, count: int, gain_sign: int) -> None:
    rows, weight, basis, pv = posed(seed, count)
    free = (rows * weight).T
    inside = free - basis.T @ (basis @ free)
    coefficients = np.linalg.lstsq(inside, pv, rcond=None)[0]
    if coefficients[0] * gain_sign < 0:
        coefficients = np.concatenate(([0.0], np.linalg.lstsq(inside[:, 1:], pv, rcond=None)[0]))
    left = pv - inside @ coefficients
    how = (weight, basis, pv, gain_sign, VANISHES)
    found = lowered_by(rows, *how)
    np.testing.assert_allclose(found[2], coefficients, rtol=1e-5, atol=1e-9)
    assert np.isclose(found[3], pv @ pv - left @ left, rtol=1e-6)
    many = np.array((rows, 2.0 * rows))
    np.testing.assert_allclose(least_errors(many, *how), left @ left, rtol=1e-6)
    np.testing.assert_allclose(residuals_behind(many, *how), [left, left], atol=1e-6)


def test_a_column_that_is_not_finite_is_no_model() -> None:
    rows, weight, basis, pv = posed(1, 2)
    rows[1, 5], weight[5] = np.inf, 1.0
    how = (weight, basis, pv, 0, VANISHES)
    assert least_errors(rows[np.newaxis], *how).tolist() == [np.inf]
    assert residuals_behind(rows[np.newaxis], *how).tolist() == [pv.tolist()]
