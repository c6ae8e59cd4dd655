import numpy as np
import pytest

from simulators.parameters import ProcessParameters
from simulators.process import SimulatedProcess

DT = 0.01


def step_response(seconds, flow=2.0, load=0.0, **parameters):
    process = SimulatedProcess(ProcessParameters(**parameters), DT)
    answer = []
    for _ in range(seconds):
        process.respond(np.full(100, flow), load)
        answer.append(process.pv)
    return np.arange(1, seconds + 1.0), np.array(answer)


def test_first_order_step_response():
    t, pv = step_response(60, gain=1.5, tau=8.0, delay=4.0)
    expected = np.where(t > 4, 2 * 1.5 * (1 - np.exp(-(t - 4) / 8)), 0)
    assert pv == pytest.approx(expected, abs=1e-9)


def test_second_order_step_response():
    t, pv = step_response(80, kind="second_order", gain=-1.0, tau=10.0, tau2=4.0)
    expected = -2 * (1 - (10 * np.exp(-t / 10) - 4 * np.exp(-t / 4)) / 6)
    assert pv == pytest.approx(expected, abs=2e-3)


def test_integrating_process_ramps():
    t, pv = step_response(50, kind="integrating", gain=0.02, delay=5.0)
    assert pv == pytest.approx(0.02 * 2 * np.maximum(t - 5, 0), abs=1e-9)


def test_load_enters_behind_the_dead_time():
    t, pv = step_response(10, flow=0.0, load=3.0, gain=1.0, tau=2.0, delay=100.0)
    assert pv == pytest.approx(3 * (1 - np.exp(-t / 2)), abs=1e-9)


def test_dead_time_longer_than_a_sampling_time_keeps_order():
    process = SimulatedProcess(ProcessParameters(kind="integrating", gain=1.0, delay=2.5), DT)
    seen = []
    for flow in (1.0, 0.0, 0.0, 0.0, 0.0):
        process.respond(np.full(100, flow), 0.0)
        seen.append(process.pv)
    assert seen == pytest.approx([0, 0, 0.5, 1.0, 1.0])
