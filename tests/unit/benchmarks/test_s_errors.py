"""The likeliest errors of S, from days drawn with all of them known."""

import numpy as np
import pytest

from agent.analysis.memory.s_day import SDay
from benchmarks.s_errors import likeliest


def test_what_days_of_a_valve_have_in_common_what_each_has_and_days_that_are_astray_are_found():
    rng = np.random.default_rng(95)
    valves = []
    for k in range(100):
        sd = rng.uniform(0.03, 0.15) * rng.uniform(0.8, 1.2, 10)
        common = 0.5 + 0.8 * rng.standard_normal()
        lacks = common * (1 / sd).sum() / (1 / sd**2).sum() + (
            0.2 if k < 40 else 0.9
        ) * sd * rng.standard_normal(10)
        astray = 0.3 * rng.standard_normal(10) * (rng.random(10) < 0.15)
        days = 5.0 * np.exp(-lacks - astray)
        valves.append(
            [(SDay(0.0, float(s), float(s * each), 1.0), 5.0) for s, each in zip(days, sd, strict=True)]
        )
    found = likeliest(valves)
    assert (found.short, found.common) == pytest.approx((0.5, 0.8), abs=0.2)
    assert (found.wide, found.near, found.far) == pytest.approx((0.6, 0.2, 0.9), abs=0.15)
    assert (found.astray, found.astray_sd) == pytest.approx((0.15, 0.3), abs=0.05)
