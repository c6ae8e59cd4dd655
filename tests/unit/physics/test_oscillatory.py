"""The base that rings against its equation, integrated in small steps, and ``--base auto``."""

import numpy as np
import pytest
from scipy.signal import lsim

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases.oscillatory import Oscillatory, RingingProcess, second_order
from agent.workbench.session import Workbench

TAU, DAMPING, ZERO, DELAY = 5.0, 0.2, 1.0, 3.0
OP = np.repeat(np.random.default_rng(3).uniform(40, 60, 20), 40)
FINE = 50


def exact(late=100):
    """PV for gain one, delayed by some fine steps beside the sample that OP is held."""
    held = np.repeat(OP, FINE)
    time = np.arange(len(held)) / FINE
    system = ([ZERO * TAU, 1.0], [TAU**2, 2 * DAMPING * TAU, 1.0])
    _, response, _ = lsim(system, held - held[0], time, interp=False)
    return np.concatenate((np.zeros(late), response))[: len(held) : FINE]


@pytest.mark.parametrize("late", [0, 20, 50, 90, 100, 130])
def test_it_is_exact_for_a_held_op_at_any_dead_time(late):
    process = RingingProcess(delay=1 + late / FINE, tau=TAU, damping=DAMPING, zero=ZERO)
    assert process.respond(OP, 1.0) - OP[0] == pytest.approx(exact(late), abs=1e-6 * np.ptp(OP))


def test_a_double_pole_is_that_of_two_equal_lags():
    near = [second_order(4.0, damping, 0.0) for damping in (1.0, 1.0 + 1e-3)]
    assert near[0][0] == pytest.approx(near[1][0], rel=1e-2)
    assert sum(near[0][0]) / sum(near[0][1]) == pytest.approx(1.0)


def test_the_time_of_settling_grows_as_the_damping_falls():
    at = Oscillatory().process(np.array([1.0, 4.0, 0.1, 0.0]))
    assert at.settling == pytest.approx(120.0)


def test_the_likeliest_base_is_taken():
    noise = 0.1 * np.random.default_rng(4).standard_normal(len(OP))
    bench = Workbench(LoopWindow("ring", 0.0, 1.0, OP, 20 + 2 * exact() + noise), base="auto")
    assert bench.base.name == "oscillatory"
    found = {each.name: each.value for each in bench.step.numbers}
    expected = {"tau": TAU, "damping": DAMPING, "zero": ZERO, "gain": 2.0, "delay": DELAY}
    assert found == pytest.approx(expected, rel=0.03)
    lag = np.zeros(len(OP))
    for i in range(len(OP) - 1):
        lag[i + 1] = lag[i] + (OP[i] - OP[0] - lag[i]) / 8
    assert Workbench(LoopWindow("lag", 0.0, 1.0, OP, 20 + lag + noise), base="auto").base.name == "fopdt"
