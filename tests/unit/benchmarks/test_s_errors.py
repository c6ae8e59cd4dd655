"""The likeliest share of short days, and what they lack, from days drawn with both known."""

import numpy as np
import pytest

from agent.analysis.memory.s_day import SDay
from benchmarks.s_errors import likeliest


def test_the_share_of_short_days_and_what_they_lack_are_found():
    rng = np.random.default_rng(86)
    lacks = np.where(rng.random(3000) < 0.3, 0.2 + 0.2 * rng.standard_normal(3000), 0.0)
    seen = 5.0 * np.exp(-lacks + 0.03 * rng.standard_normal(3000))
    short, lack = likeliest([(SDay(0.0, float(s), 0.03 * float(s), 1.0), 5.0) for s in seen])
    assert short == pytest.approx(0.3, abs=0.05)
    assert lack == pytest.approx(0.2, abs=0.03)
