import math
import time

import numpy as np
import pytest

from simulators.parameters import (
    ControllerParameters,
    Drift,
    LoadStepParameters,
    Noise,
    ProcessParameters,
    Quantisation,
    SetPointStep,
    SinusoidParameters,
    ValveParameters,
)
from simulators.plant import SimulatedPlant, quantised, simulate
from simulators.scenario import Scenario


def scenario(**changes):
    parts = {
        "loop": "FIC1",
        "duration": 600.0,
        "seed": 3,
        "controller": ControllerParameters(kc=0.4, ti=8.0, sp=100.0),
        "process": ProcessParameters(gain=1.5, tau=5.0, delay=2.0),
        "noise": Noise(std=0.3),
    }
    return Scenario(**(parts | changes))


STICKING = ValveParameters(law="karnopp", f_s=5.0, f_d=1.0)


def test_run_at_once_equals_run_row_by_row():
    loop = scenario(valve=STICKING, drift=Drift(walk=0.05), disturbance=SinusoidParameters(amplitude=1))
    plant = SimulatedPlant(loop)
    record = simulate(loop)
    for i in range(loop.samples):
        row = plant.advance()
        assert row.time == record.time[i]
        assert row.values == {role: getattr(record, role)[i] for role in ("pv", "op", "sp", "mv")}


def test_same_seed_same_record_other_seed_other_record():
    first, again, other = (simulate(scenario(seed=seed)) for seed in (1, 1, 2))
    assert np.array_equal(first.pv, again.pv)
    assert not np.allclose(first.pv, other.pv)


def test_times_run_from_the_start_by_the_sampling_time():
    record = simulate(scenario(ts=0.5, start=1000.0, duration=3.0))
    assert record.time.tolist() == [1000.0, 1000.5, 1001.0, 1001.5, 1002.0, 1002.5]


def test_free_loop_holds_its_set_point():
    record = simulate(scenario(noise=Noise()))
    assert record.pv == pytest.approx(100.0, abs=1e-6)
    assert record.op == pytest.approx(50.0, abs=1e-6)


@pytest.mark.parametrize("law", ["karnopp", "lugre"])
def test_sticking_loop_cycles_and_its_valve_jumps(law):
    record = simulate(scenario(valve=ValveParameters(law=law, f_s=5.0, f_d=1.0), duration=1200.0))
    jumps = np.abs(np.diff(record.mv)) > 2.0
    assert 10 < jumps.sum() < 100
    assert np.all(np.abs(record.op[:-1] - record.mv[1:]) <= 5.01)  # the spring never beats static friction
    assert np.ptp(record.pv) > 8.0


def test_set_point_steps_are_followed():
    record = simulate(scenario(set_points=(SetPointStep(time=200.0, sp=110.0),)))
    assert record.sp[199:201].tolist() == [100.0, 110.0]
    assert record.pv[300:].mean() == pytest.approx(110.0, abs=0.2)


def test_sinusoid_swings_the_loop():
    record = simulate(scenario(disturbance=SinusoidParameters(amplitude=5.0, period=50.0), noise=Noise()))
    assert np.argmax(np.abs(np.fft.rfft(record.pv - record.pv.mean()))) == 600 / 50


def test_a_load_that_is_fed_forward_moves_op_and_hardly_pv():
    steps = tuple(LoadStepParameters(time=60.0 * k, load=6.0 * (-1) ** k) for k in range(1, 10))
    plain, fed = (
        simulate(
            scenario(
                load_steps=steps,
                controller=ControllerParameters(kc=0.4, ti=8.0, sp=100.0, feed_forward=part),
            )
        )
        for part in (0.0, 1.0)
    )
    assert np.std(fed.pv) < 0.6 * np.std(plain.pv)
    assert np.std(fed.op) > 0.9 * np.std(plain.op)


def test_op_saturates_and_comes_back():
    far = (SetPointStep(time=100.0, sp=200.0), SetPointStep(time=400.0, sp=100.0))
    record = simulate(scenario(set_points=far, noise=Noise()))  # 200 would need OP 117
    assert record.op[399] == 100.0
    assert record.pv[399] == pytest.approx(175.0, abs=0.1)
    assert record.op[400] < 80.0
    assert record.pv[-1] == pytest.approx(100.0, abs=0.1)


def test_converters_quantise():
    record = simulate(scenario(quantisation=Quantisation(pv=0.25, op=0.5)))
    for values, quantum in ((record.pv, 0.25), (record.op, 0.5)):
        assert values / quantum == pytest.approx(np.round(values / quantum), abs=1e-9)
        assert len(np.unique(values)) > 2
    assert quantised(1.26, 0.25) == 1.25
    assert quantised(math.pi, 0.0) == math.pi


def test_its_time_grows_with_the_number_of_samples():
    """In one run: three times the samples take three times as long, not nine times."""

    def seconds(duration):
        loop = scenario(valve=STICKING, duration=duration)
        simulate(loop)  # compiles
        best = math.inf
        for _ in range(3):
            began = time.process_time()
            simulate(loop)
            best = min(best, time.process_time() - began)
        return best

    assert seconds(9000.0) < 6 * seconds(3000.0)
