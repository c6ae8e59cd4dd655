"""Quantiles of a mixture of normal numbers."""

import math
from statistics import NormalDist

import pytest

from agent.analysis.wear.mixture import Normal, quantile

UNIT = NormalDist()


def test_of_one_part_they_are_those_of_the_normal_distribution():
    for probability in (0.05, 0.5, 0.95):
        expected = 2.0 + 3.0 * UNIT.inv_cdf(probability)
        assert quantile([Normal(1.0, 2.0, 9.0)], probability) == pytest.approx(expected, abs=1e-3)


def test_of_several_parts_each_probability_is_that_below_the_quantile():
    parts = [Normal(0.2, -3.0, 1.0), Normal(0.5, 0.0, 0.01), Normal(0.3, 1.0, 4.0)]
    for probability in (0.01, 0.05, 0.3, 0.5, 0.8, 0.95):
        found = quantile(parts, probability)
        below = sum(share * UNIT.cdf((found - mean) / math.sqrt(var)) for share, mean, var in parts)
        assert below == pytest.approx(probability, abs=1e-3)


def test_a_part_below_everything_counts_as_such():
    parts = [Normal(0.1, -math.inf, 1.0), Normal(0.9, 2.0, 9.0)]
    assert quantile(parts, 0.05) == -math.inf
    assert quantile(parts, 0.55) == pytest.approx(2.0, abs=1e-3)
    assert quantile([Normal(1.0, -math.inf, 1.0)], 0.95) == -math.inf
