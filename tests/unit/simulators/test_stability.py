import math

import numpy as np
import pytest
from scipy.optimize import brentq

from simulators.draws.stability import peak_sensitivity
from simulators.parameters import ControllerParameters, Noise, ProcessParameters, ValveParameters
from simulators.plant import simulate
from simulators.scenario import Scenario

PROCESSES = [
    ProcessParameters(gain=1.5, tau=10.0, delay=6.0),
    ProcessParameters(kind="second_order", gain=1.0, tau=15.0, tau2=5.0, delay=3.0),
    ProcessParameters(kind="integrating", gain=0.05, delay=4.0),
]


def sensitivity(kc, process, ti=20.0):
    return peak_sensitivity(ControllerParameters(kc=kc, ti=ti, sp=50.0), ValveParameters(), process, 1.0)


def tail(kc, process):
    """Oscillation of PV at the end of a run that began with a push, PV units."""
    scenario = Scenario(
        loop="x",
        duration=2000.0,
        warm_up=0.0,
        op_range=(-1e9, 1e9),
        controller=ControllerParameters(kc=kc, ti=20.0, sp=50.0),
        process=process,
        set_points=({"time": 0.0, "sp": 51.0},),
        noise=Noise(),
    )
    pv = simulate(scenario).pv
    return np.ptp(pv[-200:])


@pytest.mark.parametrize("process", PROCESSES, ids=lambda process: process.kind)
def test_limit_of_stability_is_where_the_simulated_loop_has_it(process):
    gains = np.geomspace(0.1, 100, 400)
    critical = next(kc for kc in gains if math.isinf(sensitivity(kc, process)))
    assert tail(0.9 * critical, process) < 0.05
    assert tail(1.1 * critical, process) > 5.0


def test_known_sensitivity():
    """IMC tuning of a lag with pure delay: L = exp(-s d) / (s (lambda + d)) with lambda = d gives Ms 1.59."""
    process = ProcessParameters(gain=1.0, tau=200.0, delay=20.0)
    dead_time = 20.0 + 0.5
    kc = 200.0 / (2 * dead_time)
    assert sensitivity(kc, process, ti=200.0) == pytest.approx(1.59, abs=0.02)


def test_sensitivity_grows_to_the_limit():
    process = PROCESSES[0]
    limit = brentq(lambda kc: 1 / sensitivity(kc, process) - 0.02, 0.5, 3.0)
    values = [sensitivity(f * limit, process) for f in (0.3, 0.6, 0.9, 1.0)]
    assert values == sorted(values)
    assert values[-1] == pytest.approx(50, rel=0.01)
