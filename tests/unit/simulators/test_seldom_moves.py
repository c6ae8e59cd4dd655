"""Loops that move seldom, and what a historian keeps of them."""

import numpy as np

from simulators.draws.seldom_moves import seldom_moved
from simulators.historian import reported
from simulators.plant import simulate


def test_the_same_seed_draws_the_same_loop_and_its_set_point_moves_seldom():
    drawn = seldom_moved(3, "seldom_stiction")
    assert drawn == seldom_moved(3, "seldom_stiction")
    assert drawn.scenario.truth.verdict == "stiction"
    assert len(np.unique(simulate(drawn.scenario).sp)) <= 6


def test_an_exception_report_is_never_farther_than_its_band():
    values = np.cumsum(np.random.default_rng(0).normal(size=500))
    sent = reported(values, 2.0)
    assert np.max(np.abs(values - sent)) <= 2.0
    assert 0 < np.count_nonzero(np.diff(sent)) < 250
    assert np.min(np.abs(np.diff(sent))[np.diff(sent) != 0]) > 2.0
