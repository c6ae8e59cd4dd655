"""What is lost when a record is thinned out before the valve (reference methods.md 0.7)."""

import itertools

import numpy as np
import pytest

from agent.physics.processes.decimation import block_means
from agent.physics.processes.fopdt import fopdt
from agent.physics.valves.two_state import two_state
from simulators.parameters import ControllerParameters, Noise, ProcessParameters, ValveParameters
from simulators.plant import simulate
from simulators.scenario import Scenario

S = 7.0
FACTOR = 5
GRID = tuple(
    itertools.product(
        np.arange(4, 9.01, 0.25),  # S
        (0, 0.25, 0.5, 0.75, 1),  # J/S
        np.linspace(-0.9, 0.9, 7),  # force on the stem at the start over f_S
        np.arange(1, 7.01, 0.5),  # delay, samples of the record
    )
)


def loop(seed, controller, process):
    """A loop whose valve has S = 7, J = 3."""
    return Scenario(
        loop="FIC",
        duration=2000,
        seed=seed,
        controller=controller,
        valve=ValveParameters(law="karnopp", f_s=5, f_d=2),
        process=process,
        noise=Noise(std=0.1),
    )


def fast_loop(seed):
    """A flow loop with a period of 27 samples, five and a half blocks."""
    controller = ControllerParameters(kc=0.8, ti=2.5, sp=100, op=50)
    return loop(seed, controller, ProcessParameters(gain=1, tau=3, delay=1))


def slow_loop(seed):
    """A loop with a period of 187 samples."""
    controller = ControllerParameters(kc=0.6, ti=12, sp=100, op=50)
    return loop(seed, controller, ProcessParameters(gain=1, tau=10, delay=5))


def unexplained(response, pv):
    response, pv = response - response.mean(), pv - pv.mean()
    power = response @ response
    return 1.0 if power < 1e-12 else 1 - (response @ pv) ** 2 / (power * (pv @ pv))


def best_s(scenario, thinned):
    """S of the grid that explains block means of PV best; ``thinned`` is what is averaged first."""
    record, tau = simulate(scenario), scenario.process.tau
    op = block_means(record.op, FACTOR) if thinned == "op" else record.op
    pv = block_means(record.pv, FACTOR)
    errors = []
    for s, j_ratio, start, delay in GRID:
        f_s, f_d = s * (1 + j_ratio) / 2, s * (1 - j_ratio) / 2
        position = two_state(op, f_s, f_d, op[0] - start * f_s)
        if thinned == "position":
            position = block_means(position, FACTOR)
        response = np.empty(len(position))
        if thinned == "response":
            fopdt(position, position[0], tau, delay, response)
            response = block_means(response, FACTOR)
        else:
            # A block mean of PV is seen half a block after the block began.
            in_blocks = 1 + (delay - 1) / FACTOR - (FACTOR - 1) / (2 * FACTOR)
            fopdt(position, position[0], tau / FACTOR, max(1.0, in_blocks), response)
        errors.append(unexplained(response, pv))
    return GRID[int(np.argmin(errors))][0]


def test_valve_and_process_run_before_the_record_is_thinned_out():
    errors = {
        thinned: np.mean([abs(best_s(fast_loop(seed), thinned) - S) for seed in range(3)])
        for thinned in ("op", "position", "response")
    }
    assert errors["response"] <= 0.5
    assert errors["response"] + 0.5 <= errors["position"] <= 2.0
    assert errors["op"] >= 2.5


def test_a_long_period_survives_block_means_of_op():
    assert best_s(slow_loop(0), "op") == pytest.approx(S, abs=0.5)


def test_a_block_with_a_missing_sample_is_missing():
    signal = np.array([1.0, 3.0, np.nan, 5.0, 7.0, 9.0, 100.0])
    np.testing.assert_array_equal(block_means(signal, 2), [2.0, np.nan, 8.0])


def test_a_block_has_a_sample():
    with pytest.raises(ValueError, match="at least one"):
        block_means(np.ones(3), 0)
