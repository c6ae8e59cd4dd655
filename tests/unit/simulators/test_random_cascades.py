from typing import get_args

import numpy as np
import pytest

from simulators.draws.random_cascades import CascadeKind, random_cascade
from simulators.draws.random_moves import largest_rise
from simulators.plant import simulate


@pytest.mark.parametrize("kind", get_args(CascadeKind))
def test_draw_keeps_the_promise_of_its_kind(kind):
    scenario = random_cascade(1, kind)
    assert (scenario.truth.verdict == "stiction") == kind.endswith("stiction")
    record = simulate(scenario)
    assert 0 < record.op.min() < record.op.max() < 100
    forth, back = sorted((largest_rise(record.mv), largest_rise(-record.mv)), reverse=True)
    s = scenario.valve.f_s + scenario.valve.f_d
    if kind == "cascade_stiction":
        assert back > s / 2
    elif kind == "one_way_stiction":
        assert forth > s / 2
        assert back < s / 20
        assert np.ptp(record.op[:-1] - record.mv[1:]) > s / 2
    moves = np.diff(record.sp)
    one_way = bool(np.all(moves >= 0) or np.all(moves <= 0))
    assert one_way == kind.startswith("one_way")


def test_draws_repeat_and_differ():
    assert random_cascade(1, "one_way") == random_cascade(1, "one_way")
    assert random_cascade(1, "one_way") != random_cascade(2, "one_way")
