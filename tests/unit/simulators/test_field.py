"""What the field does to OP, one fault at a time."""

import numpy as np
import pytest

from simulators.field import response
from simulators.parameters import (
    ControllerParameters,
    GainStep,
    LoadStepParameters,
    ProcessParameters,
    ValveParameters,
)
from simulators.scenario import Scenario
from simulators.valve import play

UP = np.r_[np.full(5, 50.0), np.full(300, 60.0)]


def scenario(valve=None, process=None, **changes):
    return Scenario(
        loop="FIC1",
        duration=305,
        controller=ControllerParameters(kc=0.4, ti=8.0, sp=100.0),
        valve=ValveParameters(**{"tau_ip": 0, "damping": 0.05} | (valve or {})),
        process=ProcessParameters(**{"gain": 1.0, "tau": 0.01} | (process or {})),
        **changes,
    )


def moved(loop, op=UP):
    """PV from the operating point, without the sample for which OP is held."""
    return response(loop, op)[1:] - 100.0


def test_a_free_valve_follows():
    assert moved(scenario()) == pytest.approx(UP[:-1] - 50, abs=0.1)


def test_a_stop_ends_the_stroke():
    assert moved(scenario({"stops": (20.0, 54.0)})).max() == pytest.approx(4.0, abs=1e-6)


def test_little_air_makes_a_ramp():
    assert moved(scenario({"rate": 0.5}))[5:25] == pytest.approx(0.5 * np.arange(1, 21), abs=0.05)


def test_slack_is_lost_at_a_reversal():
    back = np.r_[np.full(5, 50.0), np.full(50, 60.0), np.full(50, 57.0)]
    pv = moved(scenario({"backlash": 4.0}), back)
    assert pv[50] == pytest.approx(8.0, abs=1e-6)
    assert pv[-1] == pytest.approx(8.0, abs=1e-6)  # 3 back is less than the slack
    assert scenario({"backlash": 4.0}).truth.f_s == scenario({"backlash": 4.0}).truth.f_d == 2.0


def test_a_plug_is_pushed_by_the_edges_of_its_slack():
    assert play(np.array([1.0, 3.0, 2.0, 0.0]), 0.0, 2.0).tolist() == [0.0, 2.0, 2.0, 1.0]


@pytest.mark.parametrize(("step", "least"), [(-1.0, 3.0), (1.0, 1.0)])
def test_friction_may_differ_by_direction(step, least):
    """The stem stands at 49, held against opening, until the force exceeds the friction of its way."""
    op = 50 + step * np.r_[np.zeros(20), np.linspace(0, 8, 81)]
    loop = scenario({"law": "karnopp", "f_s": 1.0, "f_d": 1.0, "closing": 3.0})
    pv = response(loop, op)
    first = 10 + np.flatnonzero(np.abs(pv[10:] - pv[10]) > 0.02)[0]
    assert abs(op[first] - 49.0) == pytest.approx(least, abs=0.25)


@pytest.mark.parametrize("rangeability", [20.0, 0.05])
def test_the_trim_makes_flow_of_stroke(rangeability):
    pv = moved(scenario({"rangeability": rangeability}), np.r_[np.full(50, 50.0), np.full(100, 100.0)])
    at_half = 100 * (rangeability**0.5 - 1) / (rangeability - 1)
    assert pv[-1] == pytest.approx(100 - at_half, abs=1e-6)
    assert pv[-1] > 60 if rangeability > 1 else pv[-1] < 40


def test_inverse_response_begins_the_wrong_way_and_ends_right():
    """A lag less its lead: (1 - lead s) / (tau s + 1)."""
    pv = moved(scenario(process={"tau": 10.0, "lead": 6.0}))[5:]
    time = np.arange(1, len(pv) + 1)
    assert pv == pytest.approx(10 * (1 - 1.6 * np.exp(-time / 10)), abs=0.1)


def test_a_damped_transmitter_lags():
    pv = moved(scenario(sensor_tau=8.0))[5:]
    assert pv == pytest.approx(10 * (1 - np.exp(-np.arange(1, len(pv) + 1) / 8)), abs=0.02)


def test_gain_and_load_step():
    still = np.full(305, 60.0)
    pv = moved(scenario(gain_steps=(GainStep(time=100, factor=1.5),)), still)
    assert (pv[90], pv[110]) == (pytest.approx(10.0), pytest.approx(15.0))
    pv = moved(scenario(load_steps=(LoadStepParameters(time=100, load=-2.0),)), still)
    assert (pv[90], pv[110]) == (pytest.approx(10.0), pytest.approx(8.0))


def test_parts_that_cannot_be_are_refused():
    with pytest.raises(ValueError, match="lead needs a lag"):
        ProcessParameters(kind="integrating", gain=1.0, lead=2.0)
    with pytest.raises(ValueError, match="stops: expected"):
        ValveParameters(stops=(60.0, 40.0))
    with pytest.raises(ValueError, match="load_steps: must be in order of time"):
        scenario(load_steps=(LoadStepParameters(time=5, load=1), LoadStepParameters(time=1, load=2)))
