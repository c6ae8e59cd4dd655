import numpy as np
import pytest
from loops import made

from agent.workbench.projection import VANISHES, solve, target_of
from agent.workbench.record import bare_record


@pytest.fixture
def record():
    return bare_record(made())


def test_level_and_drift_leave_nothing(record):
    target = target_of(record, record.weight, linear=True)
    flat = solve(np.ones((len(record), 1)), target)
    assert flat.coefficients == pytest.approx(0.0)
    assert flat.error == pytest.approx(float(target.pv @ target.pv))


def test_coefficients_are_those_of_ordinary_least_squares(record):
    rng = np.random.default_rng(0)
    columns = rng.standard_normal((len(record), 3))
    target = target_of(record, record.weight, linear=True)
    found = solve(columns, target)
    counts = record.weight > 0
    whole = np.column_stack((columns, target.basis))[counts]
    expected, *_ = np.linalg.lstsq(whole, record.pv[counts], rcond=None)
    sign = target.gain_sign
    assert sign == 0 or np.sign(expected[0]) == sign
    assert found.coefficients == pytest.approx(expected[:3], rel=1e-6)
    missed = record.pv[counts] - whole @ expected
    assert found.error == pytest.approx(float(missed @ missed))


def test_two_columns_alike_share(record):
    target = target_of(record, record.weight, linear=True)
    column = np.random.default_rng(0).standard_normal((len(record), 1))
    one = solve(column, target)
    two = solve(np.hstack((column, column)), target)
    assert two.error == pytest.approx(one.error, rel=10 * VANISHES)
    assert two.coefficients == pytest.approx(one.coefficients[0] / 2, rel=1e-4)


def test_a_gain_of_the_wrong_sign_is_none(record):
    target = target_of(record, record.weight, linear=True)
    right = solve(record.op[:, np.newaxis], target)
    turned = type(target)(target.weight, target.pv, target.basis, -int(np.sign(right.coefficients[0])), False)
    assert solve(record.op[:, np.newaxis], turned).coefficients == pytest.approx(0.0)


def test_without_a_gain_the_response_is_pv(record):
    target = target_of(record, record.weight, linear=False)
    found = solve(np.column_stack((record.pv, np.ones(len(record)))), target)
    assert found.coefficients == pytest.approx([1.0, 0.0], abs=1e-9)
    assert found.error == pytest.approx(0.0, abs=1e-12)


def test_an_infinite_column_is_no_model(record):
    target = target_of(record, record.weight, linear=True)
    assert solve(np.full((len(record), 1), np.inf), target).error == np.inf
