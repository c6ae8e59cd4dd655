"""Which models a record cannot distinguish from the best of many."""

import numpy as np
import pytest

from agent.identify.confidence_set import LEAST_PIECES, p_of_losses, sums_of_pieces

MODELS, PIECES, LEVEL = 30, 25, 0.1


def losses(seed, worse=0.0):
    """Models that err alike on the mean, each with a luck of its own; all but the first are ``worse``."""
    drawn = np.random.default_rng(seed).chisquare(10.0, size=(MODELS, PIECES))
    drawn[1:] += worse
    return drawn


def test_the_model_with_the_least_loss_is_never_rejected():
    drawn = losses(1)
    assert p_of_losses(drawn)[np.argmin(drawn.sum(axis=1))] == 1.0


@pytest.mark.parametrize(("models", "least"), [(5, 165), (30, 150)])
def test_the_truth_among_some_that_are_as_good_stays_in_most_records(models, least):
    """The first is never chosen for its loss; a comparison of two would exclude it far more often.

    Of rivals that err independently of each other (those of a search do not) fewer than nine in ten records
    keep it, because a standard error of 25 pieces is not exact.
    """
    kept = sum(p_of_losses(losses(seed)[:models])[0] >= LEVEL for seed in range(200))
    assert least <= kept <= 195


def test_models_that_are_clearly_worse_leave():
    p = p_of_losses(losses(2, worse=10.0))
    assert p[0] == 1.0
    assert np.all(p[1:] < LEVEL)


def test_a_little_worse_in_each_piece_counts_more_than_much_worse_in_one():
    best = np.random.default_rng(3).chisquare(10.0, size=PIECES)
    once = best.copy()
    once[0] += 5.0 * PIECES
    p = p_of_losses(np.array([best, best + 2.0 + 0.1 * np.arange(PIECES), once]))
    assert p[1] < LEVEL < p[2]


def test_models_without_a_difference_all_stay():
    np.testing.assert_array_equal(p_of_losses(np.ones((3, PIECES))), 1.0)


def test_it_is_the_same_for_losses_in_any_unit_and_each_time():
    drawn = losses(4, worse=1.0)
    np.testing.assert_array_equal(p_of_losses(drawn), p_of_losses(drawn))
    np.testing.assert_allclose(p_of_losses(1e-6 * drawn), p_of_losses(drawn), atol=0.01)


def test_a_record_is_divided_into_its_periods_or_eight_pieces():
    squares = np.arange(200.0).reshape(2, 100)
    np.testing.assert_array_equal(sums_of_pieces(squares, 10), squares.reshape(2, 10, 10).sum(axis=2))
    assert sums_of_pieces(squares, 60).shape == (2, LEAST_PIECES)
