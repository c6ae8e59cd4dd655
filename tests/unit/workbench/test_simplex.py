"""The search by a simplex is that of scipy, evaluation by evaluation."""

import numpy as np
import pytest
from scipy.optimize import minimize

from agent.workbench.simplex import lowered_by_simplex

ENDS = [(40, 1.0, 1e-3), (7, 1e-5, 1e-7), (200, 1e-5, 1e-7)]
"""Evaluations for each coordinate, and how near corners and errors are at the end."""


def stepped(at):
    """An error with steps and a kink, as of a valve that slips."""
    away = at - np.linspace(0.2, 1.1, len(at))
    return float(np.sum(np.round(40 * away) ** 2) / 40 + np.abs(away).sum() + (at[0] - at[-1]) ** 2)


def smooth(at):
    return float(np.sum((at - 0.3) ** 2 * np.arange(1, len(at) + 1)))


def seen(error, found):
    def watched(at):
        found.append(at.copy())
        return error(at)

    return watched


def at_points(error):
    return lambda points: np.array([error(each) for each in points])


@pytest.mark.parametrize("error", [stepped, smooth])
@pytest.mark.parametrize("size", [1, 2, 5])
@pytest.mark.parametrize(("evaluations", "near", "flat"), ENDS)
def test_it_looks_at_the_points_that_scipy_looks_at(error, size, evaluations, near, flat):
    start = np.linspace(0.98, 0.1, size)
    ours, theirs = [], []
    found = lowered_by_simplex(at_points(seen(error, ours)), start, 0.05, evaluations, near=near, flat=flat)
    steps = np.where(start + 0.05 > 1.0, -0.05, 0.05)
    options = {"initial_simplex": np.vstack((start, start + np.diag(steps))), "maxfev": evaluations * size}
    options |= {"xatol": near, "fatol": flat}
    best = minimize(
        seen(error, theirs), start, method="Nelder-Mead", bounds=[(0.0, 1.0)] * size, options=options
    )
    np.testing.assert_allclose(np.array(ours), np.array(theirs), rtol=0, atol=1e-12)
    np.testing.assert_allclose(found, best.x, rtol=0, atol=1e-12)


def test_too_few_evaluations_for_the_first_corners_give_the_best_of_them():
    found = lowered_by_simplex(at_points(smooth), np.array([0.5, 0.5]), 0.05, 1, near=1e-5, flat=1e-7)
    assert found.tolist() == [0.5, 0.5]
