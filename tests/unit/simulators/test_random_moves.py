from typing import get_args

import numpy as np
import pytest

from simulators.draws.random_moves import DURATION, MovedKind, largest_rise, random_moved
from simulators.plant import simulate


@pytest.mark.parametrize("kind", get_args(MovedKind))
def test_draw_keeps_the_promise_of_its_kind(kind):
    scenario = random_moved(1, kind)
    assert random_moved(1, kind) == scenario
    assert random_moved(2, kind) != scenario
    assert scenario.truth.verdict == ("no_stiction" if kind == "set_point" else "stiction")
    record = simulate(scenario)
    assert 0 < record.op.min() < record.op.max() < 100
    if kind == "stiction_sinusoid":
        assert scenario.disturbance.amplitude > 0
        return
    assert DURATION[0] <= len(record.op) <= DURATION[1]
    assert len(np.unique(record.sp)) > 1
    if kind == "set_point_stiction":
        half = (scenario.valve.f_s + scenario.valve.f_d) / 2
        assert largest_rise(record.mv) > half
        assert largest_rise(-record.mv) > half


def test_largest_rise():
    assert largest_rise(np.array([3.0, 1.0, 2.0, 5.0, 0.0, 3.5])) == 4.0
    assert largest_rise(np.array([3.0, 2.0, 1.0])) == 0.0
