"""The analytic cases of docs/effects."""

from dataclasses import replace

import numpy as np
import pytest

from agent.physics.bases import BASES
from agent.physics.bases.linear_process import LinearProcess
from agent.physics.effect import Facts
from agent.physics.effects.actuator_lag import ActuatorLag
from agent.physics.effects.asymmetric_stiction import AsymmetricStiction
from agent.physics.effects.characteristic import Characteristic
from agent.physics.effects.deadband import Deadband
from agent.physics.effects.gain_change import GainChange
from agent.physics.effects.hysteresis import motion_values
from agent.physics.effects.load_step import LoadStepEffect
from agent.physics.effects.rate_limit import RateLimit
from agent.physics.effects.saturation import Saturation
from agent.physics.effects.second_order import SecondOrder
from agent.physics.effects.sensor_lag import SensorLag
from agent.physics.effects.sinusoid import Sinusoid
from agent.physics.effects.stiction import Stiction
from agent.physics.loop_model import LoopModel
from agent.physics.valves.damped_stem import DampedStem
from agent.physics.valves.he2007 import He2007
from agent.physics.valves.kano2004 import kano2004
from agent.units import FrictionBands

T = np.arange(600.0)
WAVE = 50 + 10 * np.sin(2 * np.pi * T / 150)
FACTS = Facts(1.0, 600, 40.0, 60.0, 0.0, 1.0, 150.0, 0.3, 1)
FOPDT, SOPDT = BASES[0], BASES[1]
MOTION = motion_values(DampedStem(), 1.0)


def test_a_dead_band_takes_its_width_from_every_stroke():
    position = Deadband().apply(WAVE, np.array([6.0, 3.0, 0.01]), 1.0)
    assert np.ptp(position[150:]) == pytest.approx(20 - 6, abs=0.02)


def test_a_stem_that_takes_its_time_brings_less_of_a_spike_to_the_edges_of_its_slack():
    spike = np.where(T == 300, 10.0, 0.0)
    moved = [
        np.ptp(Deadband().apply(50 + spike, np.array([6.0, 3.0, damping]), 1.0)) for damping in (0.01, 0.9)
    ]
    assert moved[0] == pytest.approx(10 - 3)
    assert moved[1] == pytest.approx(10 * (1 - np.exp(-1 / 0.9)) - 3)


def test_a_stem_that_cannot_slip_far_is_late_by_half_of_s_on_either_stroke():
    position = Stiction().apply(WAVE, np.array([6.0, 0.0, 3.0, *MOTION]), 1.0)
    assert np.ptp(position[150:]) == pytest.approx(20 - 6, abs=0.3)


def test_both_slip_jumps_alike_are_stiction():
    bands = FrictionBands(4.0, 1.5)
    stem = DampedStem(damping=0.4, rest=0.05)
    alike = AsymmetricStiction().apply(WAVE, AsymmetricStiction().values_of(bands, 2.0, stem, 0.5), 0.5)
    np.testing.assert_allclose(
        alike, Stiction().apply(WAVE, Stiction().values_of(bands, 2.0, stem, 0.5), 0.5)
    )
    np.testing.assert_allclose(alike, stem.position(WAVE, bands, WAVE[0] + 2.0 - bands.f_s))


def test_another_law_has_no_motion_to_search():
    bands, law = FrictionBands(4.0, 1.5), He2007()
    effect = Stiction(law=law)
    values = effect.values_of(bands, 2.0, DampedStem(), 1.0)
    np.testing.assert_allclose(values, [5.5, 2.5 / 5.5, 2.0])
    np.testing.assert_allclose(
        effect.apply(WAVE, values, 1.0), law.position(WAVE, bands, WAVE[0] + 2.0 - bands.f_s)
    )


def test_a_falling_stem_with_more_static_friction_slips_further():
    op = 50 + np.concatenate([np.arange(0, 20, 0.02), np.arange(20, 0, -0.02)])
    position = AsymmetricStiction().apply(op, np.array([2.0, 1.0, 5.0, 2.0, *MOTION[:3]]), 1.0)
    up, down = np.diff(position)[:1000], np.diff(position)[1000:]
    assert -down.min() > 3 * up.max()


def test_kinetic_friction_by_direction_is_only_a_shift_of_the_position():
    """Four bands, f_S and f_D up and down; docs/effects/asymmetric_stiction.md."""
    op = WAVE + np.random.default_rng(0).normal(size=600)
    f_s, f_d, shift = (5.0, 4.0), (2.0, 2.0), 1.25
    same = kano2004(op, f_s[0] + f_d[0], f_s[0] - f_d[0], f_s[1] + f_d[1], f_s[1] - f_d[1], op[0])
    up, down = (f_s[0] + shift, f_d[0] + shift), (f_s[1] - shift, f_d[1] - shift)
    moved = kano2004(op, sum(up), up[0] - up[1], sum(down), down[0] - down[1], op[0] - shift)
    np.testing.assert_allclose(moved, same - shift, atol=1e-9)


def test_beyond_the_stops_the_valve_stands():
    position = Saturation().apply(WAVE, np.array([45.0, 58.0]), 1.0)
    assert (position.min(), position.max()) == (45.0, 58.0)
    inside = (WAVE > 45) & (WAVE < 58)
    np.testing.assert_array_equal(position[inside], WAVE[inside])


def test_a_stop_may_lie_anywhere_but_two_make_no_relay():
    assert Saturation().apply(WAVE, np.array([40.0, 42.0]), 1.0).max() == 42.0
    assert Saturation().apply(WAVE, np.array([58.0, 60.0]), 1.0).min() == 58.0
    np.testing.assert_array_equal(Saturation().apply(WAVE, np.array([48.0, 52.0]), 1.0), WAVE)


@pytest.mark.parametrize("curvature", [0.03, -0.03])
def test_equal_steps_of_op_change_the_slope_by_equal_shares(curvature):
    flow = Characteristic().apply(np.linspace(0, 100, 101), np.array([curvature]), 1.0)
    slopes = np.diff(flow)
    np.testing.assert_allclose(slopes[1:] / slopes[:-1], np.exp(curvature))


def test_the_rangeability_of_a_trim_is_its_curvature_over_the_stroke():
    """IEC 60534-2-4: flow R^(x - 1) for x from 0 to 1, here up to gain and level."""
    stroke = np.linspace(0, 100, 50)
    trim = 50.0 ** (stroke / 100 - 1)
    flow = Characteristic().apply(stroke, np.array([np.log(50.0) / 100]), 1.0)
    fitted = np.polyval(np.polyfit(flow, trim, 1), flow)
    np.testing.assert_allclose(fitted, trim, atol=1e-9)


def test_a_rate_limit_lets_a_step_become_a_ramp():
    step = np.where(T < 10, 0.0, 7.0)
    position = RateLimit().apply(step, np.array([0.5]), 2.0)
    np.testing.assert_allclose(position[9:18], [*range(8), 7])


def test_an_actuator_has_gone_63_percent_after_its_time_constant():
    step = np.where(T < 10, 3.0, 5.0)
    position = ActuatorLag().apply(step, np.array([20.0]), 1.0)
    assert position[9] == 3.0
    assert position[29] == pytest.approx(3 + 2 * (1 - np.exp(-1)))


def test_a_lag_more_is_the_base_of_second_order():
    values = np.array([4.0, 12.0, 5.0])
    more = LoopModel(FOPDT, (SecondOrder(),)).columns(WAVE, values, FACTS)
    np.testing.assert_allclose(more, LoopModel(SOPDT).columns(WAVE, values, FACTS), atol=1e-12)


def test_a_lag_of_the_sensor_differs_from_one_of_the_process_by_a_thousandth():
    """Why both are of one family."""
    values = np.array([4.0, 12.0, 5.0])
    process, sensor = (
        LoopModel(FOPDT, (each,)).columns(WAVE, values, FACTS) for each in (SecondOrder(), SensorLag())
    )
    assert np.std(process - sensor) < 1e-3 * np.std(process)


@pytest.mark.parametrize("cycles", [100.5, 100.25, 700.4])
def test_a_wave_under_noise_is_spotted_near_enough_to_begin_from(cycles):
    """400 points over all frequencies are five cycles apart here."""
    n = 10_000
    random = np.random.default_rng(0)
    residual = np.sin(2 * np.pi * cycles * np.arange(n) / n) + 3 * random.standard_normal(n)
    residual[2000:2500] = np.nan
    spots = Sinusoid().spotted(residual, replace(FACTS, samples=n))
    assert spots.shape == (6, 1)
    assert spots[0, 0] * n == pytest.approx(cycles, abs=0.3)


def test_nothing_is_spotted_in_nothing():
    assert Sinusoid().spotted(np.zeros(600), FACTS).shape == (0, 1)


def test_a_load_step_has_gone_63_percent_after_its_lag():
    column, later, _ = LoadStepEffect().columns(T, WAVE, np.array([100.0, 200.0, 300.0, 30.0])).T
    assert np.all(column[:101] == 0)
    assert column[130] == pytest.approx(1 - np.exp(-1))
    np.testing.assert_allclose(later[100:], column[:-100])
    sudden = LoadStepEffect().columns(T, WAVE, np.array([100.0, 200.0, 50.0, 0.0])).T
    np.testing.assert_array_equal(sudden, [T > 100, T > 200, T > 50])


@pytest.mark.parametrize("instants", [(170.0, 230.0, 300.0), (420.0, 90.0, 250.0)])
def test_a_load_that_comes_and_goes_is_spotted(instants):
    left = LoadStepEffect().columns(T, WAVE, np.array([*instants, 0.0])) @ [3.0, -4.0, 2.0] + 0.01 * T
    left[:40] = np.nan
    sudden = LoadStepEffect().spotted(left, FACTS)[0]
    assert sorted(sudden[:3]) == pytest.approx(sorted(instants), abs=FACTS.duration / 100)
    assert sudden[3] == 0


def test_a_gain_change_makes_no_difference_where_the_flow_is_balanced():
    response = np.where(T < 300, WAVE, 50.0 + 0.15 * np.ptp(WAVE))
    column = GainChange().columns(T, response, np.array([299.0, 0.15, 0.0]))[:, 0]
    np.testing.assert_allclose(column, 0, atol=1e-9)
    column = GainChange().columns(T, WAVE, np.array([299.0, -0.1, 0.0]))[:, 0]
    np.testing.assert_allclose(column[300:], WAVE[300:] - WAVE[:300].mean() + 0.1 * np.ptp(WAVE))
    assert not column[:300].any()


def test_a_first_order_process_takes_up_another_gain_of_its_inflow_with_its_own_lag():
    lag, instant, factor = 12.0, 299.0, 1.5
    inflow = WAVE - 48.0
    process = LinearProcess(delay=1.0, lags=(lag,))
    before = process.respond(inflow, 1.0)
    after = process.respond(inflow * np.where(instant <= T, factor, 1.0), 1.0)
    balanced = -inflow[0]  # the response is counted from where the inflow began
    pivot = (balanced - before[instant >= T].mean()) / np.ptp(before)
    column = GainChange().columns(T, before, np.array([instant, pivot, lag]))[:, 0]
    np.testing.assert_allclose(before + (factor - 1) * column, after, atol=1e-3 * np.ptp(before))


def test_the_stem_acts_behind_the_actuator_and_before_the_trim_however_they_were_added():
    chain = (RateLimit(), Deadband(), Characteristic())
    values = {"rate_limit": [0.2], "deadband": [3.0, 1.0, 0.2], "characteristic": [0.05]}
    position = WAVE
    for effect in chain:
        position = effect.apply(position, np.array(values[effect.name]), 1.0)
    for order in (chain, chain[::-1]):
        model = LoopModel(FOPDT, order)
        own = np.concatenate([[4.0, 12.0], *(values[effect.name] for effect in order)])
        np.testing.assert_array_equal(model.position(WAVE, own, FACTS), position)
