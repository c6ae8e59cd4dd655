"""The likeliest share of valves whose days are short, and what they lack, from days drawn with both known."""

import numpy as np
import pytest

from agent.analysis.memory.s_day import SDay
from benchmarks.s_errors import likeliest


def test_the_share_of_valves_whose_days_are_short_and_what_they_lack_are_found():
    rng = np.random.default_rng(86)
    valves = []
    for k in range(200):
        lacks = 0.2 + 0.2 * rng.standard_normal(10) if k < 60 else 0.0
        seen = 5.0 * np.exp(-lacks + 0.03 * rng.standard_normal(10))
        valves.append([(SDay(0.0, float(s), 0.03 * float(s), 1.0), 5.0) for s in seen])
    share, lack = likeliest(valves)
    assert share == pytest.approx(0.3, abs=0.05)
    assert lack == pytest.approx(0.2, abs=0.03)
