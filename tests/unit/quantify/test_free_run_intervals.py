"""Intervals and profile of ``free_run`` on models made by hand: the union over the basins that fit alike."""

from types import SimpleNamespace

import numpy as np
import pytest

from agent.analysis.quantify.free_run.found import Found
from agent.analysis.quantify.free_run.intervals import (
    LEAST_P,
    MARGIN_J,
    MARGIN_S,
    alike,
    process_intervals,
    profile,
    same_structure,
    stiction_estimate,
)
from agent.identify.fitted import Fitted
from agent.identify.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    J_RATIO,
    LOG_TAU,
    SIZE,
    SOPDT,
    S,
)

SPAN = 10.0
PROBLEM = SimpleNamespace(op_span=SPAN)


def fitted(error, s, j, structure=FOPDT, delay=3.0):
    candidate = np.zeros(SIZE)
    candidate[S], candidate[J_RATIO] = s, j / s
    candidate[DELAY], candidate[LOG_TAU] = delay, np.log(5.0)
    return Fitted(error, structure, candidate)


def found_of(best, others):
    """A model whose error is 2.5 times the least has the least p that counts."""
    p = np.array([LEAST_P ** ((each.error - best.error) / 1.5) for each in others])
    return Found(best, best, others, p, PROBLEM, "white")


def test_models_count_as_alike_from_the_limit():
    best, near, far = fitted(1.0, 2.0, 1.0), fitted(2.4, 3.0, 1.0), fitted(2.6, 9.0, 1.0)
    assert alike(found_of(best, (best, near, far))) == [best, best, near]


def test_an_interval_is_the_union_over_the_basins():
    best, other = fitted(1.0, 2.0, 1.0), fitted(1.25, 4.0, 0.5)
    found = stiction_estimate(found_of(best, (best, other, fitted(9.0, 8.0, 1.0))), PROBLEM)
    assert (found.s.value, found.s.low, found.s.high) == pytest.approx(
        (2.0, 2.0 - MARGIN_S * SPAN, 4.0 + MARGIN_S * SPAN)
    )
    assert (found.j.value, found.j.low, found.j.high) == pytest.approx(
        (1.0, 0.5 - MARGIN_J * SPAN, 1.0 + MARGIN_J * SPAN)
    )
    assert not found.identifiable_s
    assert found.identifiable_j


def test_one_basin_identifies_and_no_band_is_below_zero():
    best = fitted(1.0, 2.0, 2.0)
    found = stiction_estimate(found_of(best, (best,)), PROBLEM)
    assert found.identifiable_s
    assert found.identifiable_j
    assert (found.f_s.value, found.f_d.value, found.f_d.low) == (2.0, 0.0, 0.0)


def test_far_apart_values_of_j_are_reported_as_unidentifiable():
    best, other = fitted(1.0, 3.0, 0.2), fitted(1.2, 3.1, 2.8)
    found = stiction_estimate(found_of(best, (best, other)), PROBLEM)
    assert found.identifiable_s
    assert not found.identifiable_j


def test_the_profile_ascends_and_nothing_is_better_than_the_best():
    models = tuple(fitted(error, s, 0.5) for error, s in [(1.0, 3.0), (4.0, 1.0), (2.0, 6.0), (9.0, 6.1)])
    found = profile(found_of(models[0], models), PROBLEM, 2.0)
    np.testing.assert_allclose(found.s, [1.0, 3.0, 6.0])
    np.testing.assert_allclose(found.p, LEAST_P ** np.array([2.0, 0.0, 2 / 3]))
    assert found.limit == LEAST_P
    np.testing.assert_allclose(found.delay, 6.0)
    np.testing.assert_allclose(found.j, 0.5)


SURE = {"gain": 0.0, "delay": 0.0, "tau": 0.0, "tau2": 0.0}


def test_the_process_ranges_over_what_one_path_of_the_valve_leaves_open():
    best, other = fitted(1.0, 2.0, 1.0, delay=3.0), fitted(1.1, 2.1, 1.0, delay=4.0)
    open_to = {"gain": 0.1, "delay": 2.5, "tau": np.log(2.0)}
    ranges = process_intervals(found_of(best, (best, other)), [-0.5, -0.5, -0.7], open_to, 2.0)
    assert ranges.gain == pytest.approx((-0.77, -0.45))
    assert ranges.delay == pytest.approx((2.0, 13.0))  # a sample at least
    assert ranges.tau == pytest.approx((5.0, 20.0))


def test_the_process_ranges_over_its_own_structure_only():
    best, other = fitted(1.0, 2.0, 1.0, delay=3.0), fitted(1.1, 2.1, 1.0, delay=4.0)
    found = found_of(best, (best, other, fitted(1.1, 2.1, 1.0, SOPDT, delay=9.0)))
    assert same_structure(found) == [best, best, other]
    ranges = process_intervals(found, [0.5, 0.5, 0.7], SURE, 2.0)
    assert (ranges.gain, ranges.delay, ranges.tau2) == ((0.5, 0.7), (6.0, 8.0), None)
    assert ranges.tau == pytest.approx((10.0, 10.0))


def test_an_integrator_has_no_time_constants():
    best = fitted(1.0, 2.0, 1.0, INTEGRATOR)
    ranges = process_intervals(found_of(best, (best,)), [0.1, 0.1], SURE, 2.0)
    assert (ranges.tau, ranges.tau2) == (None, None)
