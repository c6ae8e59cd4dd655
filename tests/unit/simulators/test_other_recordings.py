"""Other recordings of a loop: the plant is the same, what comes from outside is drawn anew."""

import numpy as np
import pytest

from simulators.draws.other_recordings import other_recording, recordings_of, with_something_unknown
from simulators.draws.random_cascades import random_cascade
from simulators.draws.random_flows import random_flow
from simulators.plant import simulate

PLANT = ("process", "controller", "valve", "noise", "quantisation", "sensor_tau", "duration", "ts", "wander")


def heights(scenario):
    return np.array([step.sp for step in scenario.set_points]) - scenario.controller.sp


@pytest.mark.parametrize("seed", range(4))
def test_the_plant_stays_and_the_day_is_another(seed):
    loop = random_flow(seed, "flow_stiction")
    day = other_recording(loop, np.random.default_rng(seed), one_way=False)
    assert all(getattr(day, name) == getattr(loop, name) for name in PLANT)
    assert (len(day.set_points), len(day.load_steps)) == (len(loop.set_points), len(loop.load_steps))
    assert abs(day.drift.ramp) == abs(loop.drift.ramp)
    assert day.drift.walk == loop.drift.walk
    assert not np.allclose(simulate(day).pv, simulate(loop).pv)


def test_the_same_generator_gives_the_same_days():
    loop = random_flow(1, "flow")
    one, other = (recordings_of(loop, np.random.default_rng(3), 2, one_way=False) for _ in range(2))
    assert one == other
    assert one[0] != one[1]


def test_op_stays_between_its_limits():
    loop = random_flow(1, "flow")
    for day in recordings_of(loop, np.random.default_rng(0), 3, one_way=False):
        op = simulate(day).op
        assert 0 < op.min() < op.max() < 100
    tight = loop.model_copy(update={"op_range": (loop.controller.op - 1e-3, loop.controller.op + 1e-3)})
    assert recordings_of(tight, np.random.default_rng(0), 1, one_way=False) is None


def test_a_set_point_that_goes_one_way_goes_as_far_one_way_or_the_other():
    loop = random_cascade(2, "one_way")
    ways = set()
    for seed in range(8):
        away = heights(other_recording(loop, np.random.default_rng(seed), one_way=True))
        steps = np.diff(away, prepend=0.0)
        assert np.all(steps >= 0) or np.all(steps <= 0)
        assert np.max(np.abs(away)) == pytest.approx(np.max(np.abs(heights(loop))))
        ways.add(float(np.sign(away[-1])))
    assert ways == {-1.0, 1.0}


def test_a_set_point_that_wanders_keeps_its_spectrum():
    loop = random_cascade(3, "cascade")
    day = other_recording(loop, np.random.default_rng(0), one_way=False)
    assert [step.time for step in day.set_points] == [step.time for step in loop.set_points]
    one, other = (np.abs(np.fft.rfft(heights(each)))[1:-1] for each in (loop, day))
    assert other == pytest.approx(one, rel=1e-6)
    assert not np.allclose(heights(loop), heights(day))


def test_something_unknown_is_one_thing_of_four():
    loop = random_flow(0, "flow")
    changed = set()
    for seed in range(40):
        other = with_something_unknown(loop, np.random.default_rng(seed))
        differs = [name for name in type(loop).model_fields if getattr(other, name) != getattr(loop, name)]
        assert len(differs) == 1
        changed |= set(differs)
    assert changed == {"valve", "sensor_tau", "gain_steps", "process"}
