"""Lanes as the processor computes them against the same source on arrays of numpy."""

import numpy as np
import pytest

from agent.jit import kernel
from agent.lanes import (
    WIDTH,
    any_of,
    choose,
    exp,
    larger,
    least_of,
    load,
    log,
    most_of,
    no_lane,
    smaller,
    splat,
    store,
    where,
)

UNITS = 2
"""Of the last place."""


@kernel
def everything(rows, out):
    """Use each operation; return what is not written into rows."""
    total = 0.0
    for row in range(len(rows)):
        x = load(rows, row)
        inside = ((x < 2.0) & (x >= -1.0)) | ~((x > -3) | (x <= -6.0))
        y = where(inside, exp(x), log(larger(x, 0.5)))
        if any_of(choose(inside, no_lane(), x > 5.0)):
            y = y + 1.0
        store(out, row, smaller(-y * 2.0, 5.0) - splat(1.0) / x)
        total += least_of(x) * most_of(y)
    return total


def test_every_operation_is_that_of_numpy():
    rows = np.random.default_rng(0).normal(0, 4, (500, WIDTH))
    compiled, plain = np.empty_like(rows), np.empty_like(rows)
    assert everything(rows, compiled) == pytest.approx(everything.py_func(rows, plain), rel=1e-13)
    np.testing.assert_allclose(compiled, plain, rtol=1e-13)


@kernel
def exponentials(rows):
    for row in range(len(rows)):
        store(rows, row, exp(load(rows, row)))


@kernel
def logarithms(rows):
    for row in range(len(rows)):
        store(rows, row, log(load(rows, row)))


def test_exp_and_log_are_right_to_two_units_of_the_last_place():
    exponents = np.random.default_rng(1).uniform(-690, 690, (2000, WIDTH))
    exponents[0] = 0.0
    exact = np.exp(exponents)
    rows = exponents.copy()
    exponentials(rows)
    assert np.max(np.abs(rows - exact) / np.spacing(exact)) <= UNITS
    rows = exact.copy()
    rows[1] = 1.0 + np.linspace(-0.3, 0.42, WIDTH)
    expected = np.log(rows)
    logarithms(rows)
    assert np.max(np.abs(rows - expected) / np.spacing(np.maximum(np.abs(expected), 1e-3))) <= UNITS
