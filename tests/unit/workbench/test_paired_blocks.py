"""What held-out blocks say of two models."""

import numpy as np
import pytest
from scipy import stats

from agent.workbench.paired_blocks import known_blocks, lowers_error, reduction, sign_flip_p, stretches
from agent.workbench.residual.holm import LEVEL, holm

BLOCKS = 24


def base_losses(rng, blocks=BLOCKS):
    return rng.gamma(4.0, 1.0, blocks)


def less(rng, losses, percent, scatter=0.1):
    """Losses of a model that makes ``percent`` less error, each block by its own luck."""
    return losses * (1 - percent / 100) * np.exp(scatter * rng.normal(size=len(losses)))


def test_holm_by_hand():
    np.testing.assert_allclose(holm(np.array([0.01, 0.04, 0.03, 0.005])), [0.03, 0.06, 0.06, 0.02])
    np.testing.assert_allclose(holm(np.array([0.6, 0.5])), [1.0, 1.0])
    assert holm(np.empty(0)).size == 0


def test_stretches_hold_every_block_once():
    assert stretches(np.ones(10)).tolist() == [1.0] * 10
    assert stretches(np.ones(40)).sum() == 40
    assert len(stretches(np.ones(40))) == 14


def test_sign_flips_are_those_of_scipy():
    rng = np.random.default_rng(3)
    base, other = rng.gamma(4.0, 1.0, (2, 10))
    exact = stats.permutation_test(
        (base - other,), np.mean, permutation_type="samples", alternative="greater", n_resamples=np.inf
    )
    assert sign_flip_p(base, other) == pytest.approx(exact.pvalue)


def test_models_that_are_alike_have_p_one_and_no_reduction():
    base = base_losses(np.random.default_rng(0))
    assert sign_flip_p(base, base) == 1.0
    found = reduction(base, base, np.random.default_rng(0))
    assert (found.percent, found.low, found.high) == (0.0, 0.0, 0.0)


def test_a_reduction_is_that_of_all_blocks():
    rng = np.random.default_rng(1)
    base = base_losses(rng)
    found = reduction(base, less(rng, base, 60), rng)
    assert found.low < found.percent < found.high
    assert found.percent == pytest.approx(60, abs=4)


@pytest.mark.parametrize(
    ("other", "lower"),
    [
        (np.full(BLOCKS, 0.6), True),
        (np.full(BLOCKS, 0.97), False),
        (np.where(np.arange(BLOCKS) < 2, 0.1, 1.02), False),
        (np.full(BLOCKS, 1.4), False),
    ],
    ids=["much", "too little to matter", "in two blocks only", "more"],
)
def test_an_error_is_lower_where_it_is_so_by_as_much_as_counts_and_surely(other, lower):
    assert lowers_error(np.ones(BLOCKS), other, LEVEL) is lower


def test_a_block_without_an_error_counts_for_no_model():
    base = base_losses(np.random.default_rng(6))
    holed = 0.5 * base
    holed[3] = np.nan
    kept = np.delete(base, 3)
    np.testing.assert_array_equal(known_blocks(base, holed), [kept, 0.5 * kept])
    assert lowers_error(base, holed, LEVEL)


def test_what_gains_nothing_hardly_ever_lowers_the_error():
    """Ten that gain nothing in blocks whose luck is shared with their neighbours'."""
    lower = 0
    for seed in range(100):
        rng = np.random.default_rng(seed)
        base = base_losses(rng, 30)
        luck = 0.3 * (rng.normal(size=(10, 31))[:, 1:] + rng.normal(size=(10, 31))[:, :-1])
        lower += any(lowers_error(base, base * np.exp(each), LEVEL / 10) for each in luck)
    assert lower <= 1


def test_the_interval_of_a_reduction_holds_the_truth():
    held, runs, scatter = 0, 200, 0.3
    true = 100 * (1 - 0.6 * np.exp(scatter**2 / 2))
    for seed in range(runs):
        rng = np.random.default_rng(seed)
        base = base_losses(rng)
        found = reduction(base, less(rng, base, 40, scatter), rng)
        held += found.low <= true <= found.high
    assert 0.82 * runs <= held <= 0.97 * runs
