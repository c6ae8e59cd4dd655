"""Effects beyond the valve, and balances: analytic cases, and plants integrated in continuous time."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from agent.physics.bases import BASES
from agent.physics.bases.heat_exchanger import HeatExchanger
from agent.physics.bases.heater import Heater, HeaterBase
from agent.physics.bases.lag_bases import Fopdt
from agent.physics.bases.linear_process import LinearProcess
from agent.physics.bases.neutralisation import Neutralisation
from agent.physics.bases.oscillatory import Oscillatory
from agent.physics.effect import Facts
from agent.physics.effects.deadband import backlash
from agent.physics.effects.process_friction import ProcessFriction
from agent.physics.effects.pv_gain import PvGain
from agent.physics.effects.sensor_deadband import SensorDeadband
from agent.physics.effects.split_range import SplitRange
from agent.physics.effects.square_law import SquareLaw
from agent.physics.effects.titration import Titration
from agent.physics.effects.transport_delay import TransportDelay
from agent.physics.effects.wave import RepeatingWave
from agent.physics.loop_model import LoopModel
from agent.workbench.library import applies

T = np.arange(400.0)
WAVE = 50 + 10 * np.sin(2 * np.pi * T / 100)
LEVELS = np.repeat([40.0, 70.0, 55.0, 60.0, 45.0], 80)
"""Of OP, held."""


def integrated(rates, start):
    """Solve a balance for ``LEVELS`` held sample by sample; its value at each sample."""

    def slope(t, y):
        return rates(LEVELS[min(int(t), len(LEVELS) - 1)], y)

    found = solve_ivp(slope, (0, len(LEVELS) - 1), [start], t_eval=T, max_step=0.2, rtol=1e-7, atol=1e-9)
    return found.y[0]


def test_the_slope_of_a_curve_over_pv_grows_by_its_curvature():
    curved = PvGain().apply(WAVE, np.array([0.05]), 1.0)
    slopes = np.diff(curved) / np.diff(WAVE)
    assert slopes.max() / slopes.min() == pytest.approx(np.exp(0.05 * 20), rel=0.05)


def test_a_gap_that_ends_with_the_travel_is_a_stop_and_counts_as_none():
    position = np.linspace(40.0, 60.0, 201)
    inside, to_the_end = (
        SplitRange().apply(position, np.array([50.0, width, 0.5]), 1.0) for width in (4.0, 9.5)
    )
    assert np.ptp(inside[position >= 54.0]) == pytest.approx(3.0)
    assert np.ptp(inside[(position >= 50.0) & (position <= 54.0)]) == pytest.approx(0.0)
    assert to_the_end is position


def test_a_titration_is_steepest_in_the_middle():
    slopes = np.diff(Titration().apply(WAVE, np.array([52.0, 2.0]), 1.0)) / np.diff(WAVE)
    assert slopes.max() == pytest.approx(1.0, abs=0.01)
    assert slopes.min() == pytest.approx(2.0 / np.hypot(2.0, 12.0), rel=0.05)


def test_in_the_gap_of_two_trims_nothing_flows_more():
    flow = SplitRange().apply(np.array([40.0, 50.0, 52.0, 54.0, 60.0]), np.array([50.0, 4.0, 0.5]), 1.0)
    np.testing.assert_allclose(flow, [40.0, 50.0, 50.0, 50.0, 53.0])


def test_a_sensor_with_a_band_loses_it_at_each_turn():
    assert np.ptp(SensorDeadband().apply(WAVE, np.array([4.0, 0.0]), 1.0)[100:]) == pytest.approx(16.0)


def test_what_travels_along_a_pipe_takes_its_volume_over_the_flow():
    for level, late in ((60.0, 4), (80.0, 2)):
        op = np.full(100, level)
        op[50:] += 1e-6
        out = TransportDelay().apply(op, np.array([160.0, 20.0 if late == 4 else 0.0, 0.0]), 1.0)
        assert int(np.argmax(out > level + 5e-7)) - 50 == late


@pytest.mark.parametrize(
    ("curve", "values"), [(PvGain(), (0.05,)), (SquareLaw(), (20.0,)), (Titration(), (50.0, 5.0))]
)
def test_a_curve_has_the_same_slope_at_a_level_in_every_record(curve, values):
    """Else the gain of one recording would be another one's where a model is validated."""
    high = np.linspace(60.0, 80.0, 50)
    whole = np.concatenate((np.linspace(30.0, 60.0, 50)[:-1], high))
    one, other = (np.diff(curve.apply(each, np.array(values), 1.0))[-49:] for each in (high, whole))
    np.testing.assert_allclose(one, other, rtol=1e-9)


@pytest.mark.parametrize("spread", [0.02, 0.15, 0.4])
def test_a_front_is_spread_by_a_part_of_its_time_in_the_pipe_and_comes_no_later(spread):
    for level in (60.0, 100.0):
        op = np.full(400, level)
        op[200:] += 1e-6
        late = 2000.0 / (level - 20.0)
        arrives = np.diff(TransportDelay().apply(op, np.array([2000.0, 20.0, spread]), 1.0)) * 1e6
        after = np.arange(1, 400) - 200.0
        assert arrives.sum() == pytest.approx(1.0, abs=1e-4)
        assert arrives @ after == pytest.approx(late, abs=1.01)  # each sample is held until the next
        width = np.sqrt(arrives @ (after - arrives @ after) ** 2)
        assert width == pytest.approx(spread * late, rel=0.05, abs=0.4)


def test_stirred_cells_in_a_row_are_followed_through_changes_of_flow():
    fine, cells, volume, no_flow = 20, 30, 400.0, 10.0
    op = np.repeat([40.0, 60.0, 45.0, 70.0, 50.0], 60)
    content, leaves = np.full(cells, op[0]), []
    for flow in np.repeat(op, fine):
        before = np.concatenate(([flow], content[:-1]))
        content = content + cells * (flow - no_flow) / fine / volume * (before - content)
        leaves.append(content[-1])
    expected = np.array(leaves)[fine - 1 :: fine]

    def off(spread):
        out = TransportDelay().apply(op, np.array([volume, no_flow, spread]), 1.0)
        return np.sqrt(np.mean((out - expected) ** 2))

    assert off(1 / np.sqrt(cells)) < 0.5 * off(0.0)


def test_the_square_of_a_flow_has_a_slope_that_is_the_flow():
    squared = SquareLaw().apply(WAVE, np.array([30.0]), 1.0)
    slopes = np.diff(squared) / np.diff(WAVE)
    middles = 0.5 * (WAVE[1:] + WAVE[:-1])
    np.testing.assert_allclose(slopes, (middles - 30.0) / 30.0, rtol=1e-9)
    closing = SquareLaw().apply(WAVE, np.array([90.0]), 1.0)
    np.testing.assert_allclose(np.diff(closing) / np.diff(WAVE), (90.0 - middles) / 90.0, rtol=1e-9)


def test_a_wave_has_a_sinusoid_for_each_harmonic():
    columns = RepeatingWave().columns(T, T, np.array([0.02]))
    spectrum = np.abs(np.fft.rfft(columns, axis=0))
    assert spectrum.argmax(axis=0).tolist() == [8, 8, 16, 16, 24, 24]
    named = RepeatingWave().solved(np.array([3.0, 4.0, 0, 0, 0, 1.0]), 1.0)
    assert named["amplitude"] == (5.0, "PV")
    assert named["amplitude_3"] == (1.0, "PV")


def test_a_rubbing_mass_moves_as_in_continuous_time():
    friction, tau, drive = 3.0, 9.0, 8 * np.sin(2 * np.pi * T / 90)
    process = ProcessFriction().change(LinearProcess(1.0, (tau, 0.0), integrates=True), np.array([3.0, 50.0]))
    place = process.respond(50 + drive, 1.0)
    v, speeds = 0.0, []
    for u in drive:
        speeds.append(v)
        for _ in range(1000):
            force = u if v == 0.0 and abs(u) > friction else 0.0 if v == 0.0 else v
            after = v + 0.001 / tau * (u - v - friction * np.sign(force)) if force else 0.0
            v = 0.0 if after * v < 0 else after
    speed = np.diff(place - place[0]) - np.diff(place - place[0]).mean()
    middle = 0.5 * (np.array(speeds)[1:] + np.array(speeds)[:-1])
    np.testing.assert_allclose(speed, middle - middle.mean(), atol=0.02)


def test_a_heater_follows_its_balance():
    vessel = Heater(1.0, 0.4, 0.02, 0.05, 20.0, -273.0, 150.0)

    def rates(u, y):
        cold = vessel.surroundings - vessel.absolute_zero
        radiated = ((y - vessel.absolute_zero) ** 4 - cold**4) / (4 * cold**3)
        return vessel.heat * u - vessel.loss * (y - vessel.surroundings) - vessel.radiation * radiated

    pv = vessel.respond(LEVELS, 1.0)
    np.testing.assert_allclose(pv, integrated(rates, 150.0), atol=0.005 * np.ptp(pv))


def test_a_heat_exchanger_follows_its_balance_and_its_gain_falls_with_the_flow():
    exchanger = HeatExchanger(1.0, 0.002, 10.0, 0.2, 40.0, 20.0, 110.0, 70.0)

    def rates(u, y):
        flow = u - 10.0
        return 0.002 * flow * (20.0 - y) + 0.2 * flow / (flow + 40.0) * (110.0 - y)

    pv = exchanger.respond(LEVELS, 1.0)
    np.testing.assert_allclose(pv, integrated(rates, 70.0), atol=1e-3)
    first, second, third = pv[79], pv[159], pv[239]
    assert abs(first - third) / 15 > 1.1 * abs(second - third) / 15


def test_a_neutralisation_balances_its_charges():
    tank = Neutralisation(1.0, 12.0, 52.0, 300.0, 500.0, 6.4, 5.0)
    pv = tank.respond(LEVELS, 1.0)
    buffered = 500.0 * (1 / (1 + 10 ** (6.4 - pv)) - 1 / (1 + 10 ** (6.4 - 7)))
    excess = (10 ** (pv - 7) - 10 ** (7 - pv) + buffered) / 300.0
    expected = integrated(lambda u, x: (u - 52.0 - x) / 12.0, excess[0])
    np.testing.assert_allclose(excess, expected, atol=0.01)
    assert pv[0] == pytest.approx(5.0)


@pytest.mark.parametrize("base", [Fopdt(), Oscillatory()])
def test_a_curve_over_pv_lies_at_the_level_of_op_on_every_base(base):
    """Its middle is searched between the least and the greatest OP, also where OP begins far above 0."""
    facts = Facts(1.0, 420, 40.0, 60.0, 0.0, 1.0, 50.0, 1.0, 1)
    model = LoopModel(base, (Titration(),))
    quick = {"delay": 1.0, "tau": 0.2, "damping": 1.0, "zero": 0.0, "titration.middle": 52.0}
    values = np.array([quick.get(name, 0.5) for name, _ in model.parameters(facts)])
    op = np.repeat(np.linspace(40.0, 60.0, 21), 20)
    moves = np.diff(model.columns(op, values, facts)[19::20, 0])
    assert {*op[19::20][np.argsort(-moves)[:2]]} == {51.0, 52.0}  # to and from 52


def test_a_band_of_a_sensor_is_in_pv_units_on_a_balance_and_in_op_units_on_a_linear_base():
    facts = Facts(1.0, len(LEVELS), 40.0, 60.0, 100.0, 160.0, 50.0, 1.0, 1)
    found = {}
    for base in BASES:
        if applies(SensorDeadband(), base):
            named = dict(LoopModel(base, (SensorDeadband(),)).parameters(facts))
            band = named["sensor_deadband.band"]
            assert (band.unit, band.high) == (("OP", 20.0) if base.linear else ("PV", 60.0))
            found[base.name] = base.linear
    assert not all(found.values())
    assert {each.name for each in BASES if not each.linear} <= set(found)


def test_a_balance_is_measured_by_a_sensor_with_a_band():
    vessel = (1.0, 0.4, 0.02, 0.05, 20.0, -273.0, 150.0)
    facts = Facts(1.0, len(LEVELS), LEVELS.min(), LEVELS.max(), 100.0, 160.0, 50.0, 1.0, 1)
    model = LoopModel(HeaterBase(), (SensorDeadband(),))
    measured = model.columns(LEVELS, np.array([*vessel, 6.0, 0.0]), facts)
    true = LoopModel(HeaterBase()).columns(LEVELS, np.array(vessel), facts)
    off = np.abs(measured - true)
    assert off.max() == pytest.approx(3.0)
    np.testing.assert_allclose(measured[:, 0], backlash(true[:, 0], 6.0, float(true[0, 0])))
