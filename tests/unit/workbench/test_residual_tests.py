"""Whiteness, independence, noise floor and power against known truth."""

import numpy as np
import pytest
from scipy import signal

from agent.identify.noise.autoregression import Innovations
from agent.workbench.innovations import likelihood_ratio
from agent.workbench.residual.independence import independence
from agent.workbench.residual.noise_floor import noise_floor
from agent.workbench.residual.power import NUMBERS, smallest_reduction
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.residual.whiteness import LAGS, whiteness

N = 1500
SEEDS = 200


def coloured(rng, pole=0.9):
    return signal.lfilter([1.0], [1.0, -pole], rng.normal(size=N))


def test_white_noise_is_within_the_band():
    inside, rejected = [], 0
    for seed in range(SEEDS):
        found = whiteness(np.random.default_rng(seed).normal(size=N))
        inside.append(np.abs(found.correlation) <= found.band)
        rejected += found.p < 0.05
    assert 0.985 <= np.mean(inside) <= 0.995
    assert 0.02 * SEEDS <= rejected <= 0.09 * SEEDS


def test_coloured_noise_is_not_white():
    found = whiteness(coloured(np.random.default_rng(0)))
    assert found.p < 1e-6
    np.testing.assert_allclose(found.correlation[:3], [0.9, 0.81, 0.73], atol=0.08)


def test_gaps_leave_the_whiteness_of_what_is_there():
    residual = np.random.default_rng(1).normal(size=N)
    residual[300:700] = np.nan
    assert whiteness(residual).p > 0.05
    assert whiteness(np.zeros(N)) is None
    assert whiteness(np.arange(40.0)) is None


def test_a_coloured_residual_independent_of_a_coloured_op_is_within_the_band():
    inside, rejected = [], 0
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        found = independence(coloured(rng), coloured(rng, 0.98))
        inside.append(np.abs(found.correlation) <= found.band)
        rejected += found.p < 0.05
    assert 0.98 <= np.mean(inside) <= 0.998
    assert rejected <= 0.09 * SEEDS


def test_op_that_answers_to_the_residual_does_not_deceive_at_positive_lags():
    rejected = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        residual = coloured(rng)
        op = -signal.lfilter([0.2], [1.0, -0.95], residual)  # a controller that sees the residual at once
        rejected += independence(residual, op).p < 0.05
    assert rejected <= 5


def test_a_lag_that_the_model_lacks_is_seen_where_it_is():
    rng = np.random.default_rng(2)
    op = np.repeat(rng.normal(size=N // 10), 10)
    missed = np.zeros(N)
    missed[7:] = op[:-7]
    found = independence(coloured(rng) + missed, op)
    assert found.p < 0.001
    assert 1 + int(np.argmax(np.abs(found.correlation))) == 7


def test_independence_without_information():
    rng = np.random.default_rng(0)
    assert independence(np.zeros(N), rng.normal(size=N)) is None
    assert independence(rng.normal(size=N), np.ones(N)) is None
    assert len(independence(rng.normal(size=N), rng.normal(size=N)).band) == LAGS


def test_the_floor_of_a_model_that_leaves_white_noise_is_that_noise():
    held = 0
    for seed in range(100):
        rng = np.random.default_rng(seed)
        residual = 0.3 * rng.normal(size=N)
        losses = np.mean((0.3 * rng.normal(size=(15, 100))) ** 2, axis=1)
        found = noise_floor(residual, losses, rng)
        held += found.low <= 0.3 <= found.high
        assert found.low == pytest.approx(0.3, rel=0.15)
        assert found.high == pytest.approx(0.3, rel=0.15)
    assert held >= 85


def test_a_missing_effect_and_slow_noise_leave_the_floor_open():
    rng = np.random.default_rng(0)
    residual = 0.1 * rng.normal(size=N) + np.sin(np.arange(N) / 20)
    found = noise_floor(residual, np.mean(residual.reshape(15, 100) ** 2, axis=1), rng)
    assert 0.08 <= found.low <= 0.12
    assert found.high >= 0.7


def test_a_residual_of_gaps_has_no_lower_end():
    losses = np.array([1.0, np.nan, 1.2, 0.8])
    found = noise_floor(np.full(N, np.nan), losses, np.random.default_rng(0))
    assert found.low == 0.0
    assert 0.9 < found.high < 1.1


@pytest.mark.parametrize(
    ("samples", "candidates", "percent"), [(200, 24, 12.6), (300, 24, 8.8), (5000, 24, 5.0)]
)
def test_the_smallest_effect_is_that_of_the_likelihood_or_what_counts(samples, candidates, percent):
    assert smallest_reduction(samples, candidates) == pytest.approx(percent, abs=0.1)


def test_the_likelihood_of_the_smallest_effect_is_just_very_strong():
    n, tries, support = 300, 24, []
    share = smallest_reduction(n, tries) / 100
    for seed in range(30):
        white, course = np.random.default_rng(seed).standard_normal((2, n))
        course -= white * (white @ course) / (white @ white)  # so that its share is known
        course *= np.sqrt(share / (1 - share) * (white @ white) / (course @ course))
        before, after = (Innovations(each, np.zeros(0), each.var()) for each in (white + course, white))
        support.append(likelihood_ratio(before, after) - NUMBERS * np.log(n) - 2 * np.log(tries))
    assert np.mean(support) == pytest.approx(VERY_STRONG, abs=2.0)
