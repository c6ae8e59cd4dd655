"""Two tanks: balance, emptying by Torricelli's law, and what runs over."""

import numpy as np
import pytest

from agent.physics.bases.two_tanks import TwoTanks, TwoTanksBase
from agent.physics.effect import Facts
from agent.physics.effects.overflow import Overflow

TS = 4.0
PLAIN = TwoTanks(
    pump=0.05, flow_1=0.04, exponent_1=0.5, flow_2=0.05, exponent_2=0.5, zero=0.0, start_1=5.0, start_2=4.0
)


def test_levels_settle_where_both_outlets_take_what_is_pumped():
    pv = PLAIN.respond(np.full(2000, 2.0), TS)
    assert pv[0] == 4.0
    assert pv[-1] == pytest.approx((0.05 * 2.0 / 0.05) ** 2)


def test_a_tank_empties_by_torricellis_law():
    """With nothing above it sqrt(x) falls in a straight line, by half the flow."""
    alone = PLAIN._replace(start_1=0.0)
    pv = alone.respond(np.zeros(30), TS)
    time = TS * np.arange(30)
    filled = time < 70.0  # the last drops: the slope of the law has no bound
    assert np.sqrt(pv[filled]) == pytest.approx(2.0 - 0.025 * time[filled], abs=0.01)
    assert pv[-1] < 0.01


def test_pv_counts_from_zero():
    lifted = PLAIN._replace(zero=3.0, start_2=7.0)
    op = np.linspace(0.0, 3.0, 200)
    assert lifted.respond(op, TS) == pytest.approx(PLAIN.respond(op, TS) + 3.0)


def test_the_lower_tank_rises_to_its_limit_and_stays():
    pv = PLAIN._replace(limit_2=6.0).respond(np.full(500, 3.0), TS)
    assert pv.max() == 6.0
    assert np.all(pv[-100:] == 6.0)


@pytest.mark.parametrize(("share", "flow"), [(0.0, 0.04 * 2.0), (0.5, 0.11), (1.0, 0.05 * 2.8)])
def test_the_share_of_the_spill_that_falls_into_the_lower_tank_lifts_it(share, flow):
    """The upper tank is full at 4: its outlet takes 0.08, the pump brings 0.14, 0.06 runs over."""
    pv = PLAIN._replace(limit_1=4.0, share=share).respond(np.full(3000, 2.8), TS)
    assert pv[-1] == pytest.approx((flow / 0.05) ** 2, rel=1e-3)


def test_limits_out_of_reach_change_nothing():
    op = 2 + np.sin(np.arange(400) / 20)
    high = Overflow().change(PLAIN, np.array([1e3, 0.7, 1e3]))
    assert np.array_equal(high.respond(op, TS), PLAIN.respond(op, TS))


def test_starts_lie_within_the_bounds_and_hold_the_mean_in_balance():
    rng = np.random.default_rng(0)
    op = 50 + 10 * rng.standard_normal(600)
    pv = 200 + 40 * rng.standard_normal(600)
    facts = Facts(
        ts=1.0,
        samples=600,
        op_low=op.min(),
        op_high=op.max(),
        pv_low=pv.min(),
        pv_high=pv.max(),
        period=60.0,
        op_speed=1.0,
        gain_sign=1,
    )
    base = TwoTanksBase()
    parameters = base.parameters(facts)
    starts = base.starts(op, pv, facts)
    assert starts.shape[1] == len(parameters)
    for values in starts:
        settled = base.process(values).respond(np.full(20_000, op.mean()), 1.0)[-1]
        assert settled == pytest.approx(pv.mean(), rel=0.02)
    inside = [
        each.low <= column.min() and column.max() <= each.high
        for each, column in zip(parameters, starts.T, strict=True)
    ]
    assert all(inside)
