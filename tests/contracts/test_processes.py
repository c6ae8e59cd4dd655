"""What every member of PROCESSES promises: agent/checks/processes.py, and what the simulator does."""

import numpy as np
import pytest

from agent.checks import checks_of
from agent.checks.processes import DELAYS, lags_of, stairs
from agent.physics.processes import PROCESSES
from simulators.parameters import ProcessParameters
from simulators.process import SimulatedProcess
from tests.reference.process_superposition import interpolated_lag

EACH = pytest.mark.parametrize("process", PROCESSES, ids=lambda process: process.name)
SIMULATED = {
    "fopdt": ProcessParameters(gain=1, tau=6.0),
    "sopdt": ProcessParameters(kind="second_order", gain=1, tau=6.0, tau2=2.5),
    "integrator": ProcessParameters(kind="integrating", gain=1),
}
FINE = 500
"""Steps of the simulator in a sample."""


def simulated(parameters, position):
    """PV of the fine-step simulator, each position held for a sample of one second."""
    process = SimulatedProcess(parameters, 1 / FINE)
    pv = []
    for held in position:
        pv.append(process.pv)
        process.respond(np.full(FINE, held - position[0]), 0.0)
    return np.array(pv)


@EACH
@pytest.mark.parametrize("check", checks_of("processes"), ids=lambda check: check.name)
def test_contract(process, check):
    check(process)


@EACH
@pytest.mark.parametrize("delay", DELAYS)
def test_it_is_what_the_simulator_does_in_fine_steps(process, delay):
    """To rounding; the simulator's own second lag sees its input half a fine step late."""
    position = stairs(3)
    parameters = SIMULATED[process.name].model_copy(update={"delay": delay - 1})
    tolerance = 1e-3 * np.ptp(position) if process.name == "sopdt" else 1e-9
    np.testing.assert_allclose(
        process.respond(position, (*lags_of(process), delay)),
        simulated(parameters, position),
        rtol=0,
        atol=tolerance,
    )


@pytest.mark.parametrize(("tau", "worst"), [(0.5, 0.20), (2.0, 0.025), (10.0, 0.0013)])
def test_interpolating_the_output_misses_what_the_exact_fraction_meets(tau, worst):
    """docs/methods/fopdt.md: 20, 2.5 and 0.13 % of a step at a delay of half a sample."""
    step = np.where(np.arange(60) < 5, 0.0, 1.0)
    truth = simulated(ProcessParameters(gain=1, tau=tau, delay=2.5), step)
    exact = PROCESSES[0].respond(step, (tau, 3.5))
    np.testing.assert_allclose(exact, truth, rtol=0, atol=1e-12)
    missed = np.max(np.abs(interpolated_lag(step, tau, 3.5) - truth))
    assert missed == pytest.approx(worst, rel=0.1)


def test_two_lags_sampled_one_after_the_other_are_not_the_second_order():
    """docs/methods/sopdt.md: off by 9 % of a step."""
    step = np.where(np.arange(60) < 5, 0.0, 1.0)
    first = np.array(interpolated_lag(step, 2.0, 1.0))
    both = np.array(interpolated_lag(np.append(first[1:], 1.0), 1.2, 1.0))
    exact = PROCESSES[1].respond(step, (2.0, 1.2, 1.0))
    assert np.max(np.abs(both - exact)) == pytest.approx(0.09, abs=0.005)
