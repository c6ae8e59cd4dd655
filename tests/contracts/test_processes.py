"""What every member of PROCESSES promises."""

import numpy as np
import pytest

from agent.physics.processes import PROCESSES
from simulators.parameters import ProcessParameters
from simulators.process import SimulatedProcess
from tests.reference.process_superposition import interpolated_lag

EACH = pytest.mark.parametrize("process", PROCESSES, ids=lambda process: process.name)
DELAYS = pytest.mark.parametrize("delay", [1.0, 1.37, 4.0, 8.9])
LAGS = {"fopdt": (6.0,), "sopdt": (6.0, 2.5), "integrator": ()}
SIMULATED = {
    "fopdt": ProcessParameters(gain=1, tau=6.0),
    "sopdt": ProcessParameters(kind="second_order", gain=1, tau=6.0, tau2=2.5),
    "integrator": ProcessParameters(kind="integrating", gain=1),
}
FINE = 500
"""Steps of the simulator in a sample."""


def stairs(seed, n=200):
    """A valve that moves every fourth sample, about 50."""
    return 50 + np.repeat(5 * np.random.default_rng(seed).standard_normal(n // 4), 4)


def simulated(parameters, position):
    """PV of the fine-step simulator, each position held for a sample of one second."""
    process = SimulatedProcess(parameters, 1 / FINE)
    pv = []
    for held in position:
        pv.append(process.pv)
        process.respond(np.full(FINE, held - position[0]), 0.0)
    return np.array(pv)


@EACH
@DELAYS
def test_it_is_linear(process, delay):
    one, other = stairs(1), stairs(2)
    parameters = (*LAGS[process.name], delay)
    np.testing.assert_allclose(
        process.respond(3 * one - 0.5 * other, parameters),
        3 * process.respond(one, parameters) - 0.5 * process.respond(other, parameters),
        rtol=0,
        atol=1e-9,
    )


@EACH
@DELAYS
def test_it_is_the_same_at_any_time_and_level(process, delay):
    position = stairs(1)
    parameters = (*LAGS[process.name], delay)
    later = np.concatenate([np.full(17, position[0]), position]) - 1000
    response = process.respond(later, parameters)
    np.testing.assert_allclose(response[:17], 0, rtol=0, atol=1e-9)
    np.testing.assert_allclose(response[17:], process.respond(position, parameters), rtol=0, atol=1e-9)


@EACH
@DELAYS
def test_a_step_starts_after_the_delay_and_ends_at_gain_or_slope_one(process, delay):
    step = np.where(np.arange(200) < 5, 50.0, 52.0)
    response = process.respond(step, (*LAGS[process.name], delay))
    first = 5 + int(delay)  # the step is in position(5)
    np.testing.assert_array_equal(response[:first], 0)
    assert response[first] > 0
    if process.name == "integrator":
        assert response[-1] == pytest.approx(2 * (199 - 5 - (delay - 1)))
    else:
        assert response[-1] == pytest.approx(2, abs=1e-9)


@EACH
def test_it_goes_on_smoothly_where_the_delay_becomes_a_whole_sample(process):
    position = stairs(1)
    for delay in (2.0, 3.0, 7.0):
        below, at, above = (
            process.respond(position, (*LAGS[process.name], delay + nudge)) for nudge in (-1e-7, 0, 1e-7)
        )
        np.testing.assert_allclose(below, at, rtol=0, atol=1e-4)
        np.testing.assert_allclose(above, at, rtol=0, atol=1e-4)


@EACH
@DELAYS
def test_it_is_what_the_simulator_does_in_fine_steps(process, delay):
    """To rounding; the simulator's own second lag sees its input half a fine step late."""
    position = stairs(3)
    parameters = SIMULATED[process.name].model_copy(update={"delay": delay - 1})
    tolerance = 1e-3 * np.ptp(position) if process.name == "sopdt" else 1e-9
    np.testing.assert_allclose(
        process.respond(position, (*LAGS[process.name], delay)),
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


@EACH
def test_what_follows_a_missing_position_is_missing(process):
    position = stairs(1)
    position[40] = np.nan
    response = process.respond(position, (*LAGS[process.name], 3.5))
    assert np.isfinite(response[:43]).all()
    assert np.isnan(response[43:]).all()


@EACH
def test_a_delay_beyond_the_record_and_an_empty_record_are_silent(process):
    lags = LAGS[process.name]
    np.testing.assert_allclose(process.respond(stairs(1), (*lags, 1e6)), 0, rtol=0, atol=1e-9)
    assert process.respond(np.empty(0), (*lags, 3.0)).shape == (0,)


@EACH
def test_the_level_of_the_kernel_is_what_the_response_is_counted_from(process):
    """Of the integrator it is where PV stands still: counted from elsewhere it ramps."""
    position, out = stairs(1), np.empty(200)
    delay = 3.5
    process.kernel(position, position[0] - 2, *LAGS[process.name], delay, out)
    added = 2 * np.maximum(0, np.arange(200) - (delay - 1)) if process.name == "integrator" else 2.0
    expected = process.respond(position, (*LAGS[process.name], delay)) + added
    np.testing.assert_allclose(out, expected, rtol=0, atol=1e-9)


@EACH
def test_parameters_out_of_bounds_are_named(process):
    lags = LAGS[process.name]
    for bad in (0.5, np.nan, np.inf):
        with pytest.raises(ValueError, match="delay"):
            process.respond(stairs(1), (*lags, bad))
    for i, name in enumerate(parameter.name for parameter in process.parameters[:-1]):
        with pytest.raises(ValueError, match=name):
            process.respond(stairs(1), (*lags[:i], 0.01, *lags[i + 1 :], 3.0))
    with pytest.raises(ValueError, match="parameters"):
        process.respond(stairs(1), (1.0,) * 5)
