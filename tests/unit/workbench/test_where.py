"""The residual against physical axes: bands, and p that a closed loop does not deceive."""

import numpy as np
import pytest
from scipy import signal

from agent.identify.noise.autoregression import MOST_LAGS, innovations
from agent.workbench.residual.axes import UNITS, last_turns, physical_axes
from agent.workbench.residual.resampling import resampled
from agent.workbench.residual.where import bins_of, panel_of, where_it_fails

N, BLOCK, PERIOD = 1500, 100, 60.0


def coloured(rng, samples=N, pole=0.9):
    return signal.lfilter([1.0], [1.0, -pole], rng.normal(size=samples))


def steps(rng, samples=N):
    """OP of an operator: level moves that know nothing of the residual."""
    return np.repeat(rng.normal(size=-(-samples // 30)), 30)[:samples] + 0.01 * rng.normal(size=samples)


def closed_loop(rng, samples=N):
    """OP of an I controller on a lag, and the disturbance, which is the residual of the true model."""
    disturbance = coloured(rng, samples)
    op, response = np.zeros(samples), 0.0
    for t in range(1, samples):
        response += (op[t - 1] - response) / 10
        op[t] = op[t - 1] - 0.03 * (response + disturbance[t])
    return disturbance, op


def axes_of(op):
    return physical_axes(op, 1.0, PERIOD)


def test_turns_are_known_once_op_came_back():
    op = np.array([0.0, 1.0, 2.0, 3.0, 2.5, 1.5, 0.0, 0.6, 2.0])
    turn, direction = last_turns(op, 1.0)
    assert turn.tolist() == [-1, -1, 0, 0, 0, 3, 3, 3, 6]
    assert direction.tolist() == [0, 0, 1, 1, 1, -1, -1, -1, 1]
    assert last_turns(np.zeros(3), 0.0)[0].tolist() == [-1, -1, -1]


def test_the_axes_of_a_triangle():
    op = signal.sawtooth(2 * np.pi * np.arange(N) / PERIOD, 0.5) * 5
    position, set_point = op + 1, np.linspace(1, 2, N)
    axes = physical_axes(op, 2.0, PERIOD, position=position, set_point=set_point)
    assert set(axes) == set(UNITS) - {"time_of_day"}
    late = slice(int(2 * PERIOD), None)
    assert np.nanmax(axes["travel_since_reversal"]) == pytest.approx(10, abs=0.4)
    assert set(np.unique(axes["direction"][late])) == {-1.0, 1.0}
    rates = np.round(np.abs(axes["op_rate"][late]), 9)
    assert np.median(rates) == pytest.approx(10 / 30 / 2)
    assert axes["oscillation_phase"][late].min() == pytest.approx(3 / PERIOD, abs=2 / PERIOD)
    assert axes["oscillation_phase"][late].max() == pytest.approx(1)


def test_an_axis_never_knows_what_comes_after():
    op = np.cumsum(np.random.default_rng(0).normal(size=300))
    least = 3.0
    for cut in (100, 200):
        for whole, part in zip(last_turns(op, least), last_turns(op[:cut], least), strict=True):
            np.testing.assert_array_equal(whole[:cut], part)


def test_time_of_day_only_where_it_differs_from_the_time():
    op = steps(np.random.default_rng(0), 400)
    assert "time_of_day" not in physical_axes(op, 60.0, PERIOD)
    hours = physical_axes(op, 3600.0, PERIOD, start=1800.0)["time_of_day"]
    assert hours[:3].tolist() == [0.5, 1.5, 2.5]
    assert hours.max() < 24


def test_a_set_point_that_stands_is_no_axis():
    op = steps(np.random.default_rng(0))
    assert "set_point" not in physical_axes(op, 1.0, PERIOD, set_point=np.full(N, 5.0))


def test_bins_of_few_values_and_of_many():
    axis = np.array([1.0, -1.0, np.nan, 1.0, -1.0])
    bins = bins_of(axis, np.zeros(5))
    assert bins.edges.tolist() == [-1.0, 0.0, 1.0]
    assert bins.members.tolist() == [
        [False, True],
        [True, False],
        [False, False],
        [False, True],
        [True, False],
    ]
    many = bins_of(np.arange(1000.0), np.zeros(1000))
    assert many.members.sum(axis=0).tolist() == [100] * 10


def test_a_known_failure_is_found_with_its_share():
    rng = np.random.default_rng(0)
    op = steps(rng)
    noise = coloured(rng, pole=0.5)
    hidden = np.roll(np.sin(1.5 * op), 1) * 3
    found = where_it_fails(hidden + noise, axes_of(op), BLOCK, rng)
    assert found[0].axis == "op_level"
    assert found[0].p < 0.01
    true = np.var(hidden) / np.var(hidden + noise)
    assert found[0].share == pytest.approx(true, abs=0.1)
    outside = (found[0].bin_means > found[0].band_high) | (found[0].bin_means < found[0].band_low)
    assert outside[[0, -1]].all()
    assert len(found[0].bin_edges) == 1 + len(found[0].bin_means)


def test_the_band_holds_95_of_100_bins_where_residual_and_op_are_unrelated():
    inside = []
    for seed in range(200):
        rng = np.random.default_rng(seed)
        residual = coloured(rng)
        panel = panel_of("op_level", residual, bins_of(steps(rng), residual), BLOCK, 1.0)
        inside.append((panel.bin_means >= panel.band_low) & (panel.bin_means <= panel.band_high))
    assert 0.92 <= np.mean(inside) <= 0.97


def test_p_is_fair_where_op_answers_to_a_coloured_residual():
    """The residual of the true model goes with OP's level far beyond the band, yet no effect is missing."""
    failures, beyond = 0, 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        disturbance, op = closed_loop(rng)
        found = where_it_fails(disturbance, axes_of(op), BLOCK, rng)
        failures += any(each.p < 0.05 for each in found)
        level = next(each for each in found if each.axis == "op_level")
        beyond += bool(np.any((level.bin_means > level.band_high) | (level.bin_means < level.band_low)))
    assert failures <= 5
    assert beyond >= 35


def test_gaps_and_constants():
    rng = np.random.default_rng(0)
    residual, op = coloured(rng), steps(rng)
    residual[200:300] = np.nan
    found = where_it_fails(residual, axes_of(op), BLOCK, rng)
    assert all(np.isfinite(each.share) and np.isfinite(each.bin_means).all() for each in found)
    assert where_it_fails(residual, {"op_level": np.zeros(N)}, BLOCK, rng) == ()
    short = np.full(N, np.nan)
    short[::2] = residual[::2]
    assert {each.p for each in where_it_fails(short, axes_of(op), BLOCK, rng)} == {1.0}


def test_a_model_without_a_fault_has_no_residual_and_no_failure():
    rng = np.random.default_rng(0)
    found = where_it_fails(np.zeros(N), axes_of(steps(rng)), BLOCK, rng)
    assert {(each.share, each.p) for each in found} == {(0.0, 1.0)}


def test_innovations_of_a_known_autoregression():
    rng = np.random.default_rng(0)
    new = rng.normal(size=4000)
    found = innovations(signal.lfilter([1.0], [1.0, -1.2, 0.5], new))
    np.testing.assert_allclose(found.coefficients, [1.2, -0.5], atol=0.05)
    assert found.variance == pytest.approx(1.0, rel=0.05)
    seen = np.isfinite(found.values)
    assert np.corrcoef(found.values[seen], new[seen])[0, 1] > 0.99


def test_innovations_of_noise_need_no_past_and_of_a_constant_are_none():
    rng = np.random.default_rng(1)
    white = rng.normal(size=1000)
    assert innovations(white).coefficients.size == 0
    assert innovations(white, longest=True).coefficients.size == MOST_LAGS
    assert innovations(np.ones(1000)) is None
    assert innovations(np.full(1000, np.nan)) is None


def test_resampled_blocks_keep_what_is_next_to_each_other():
    values = np.arange(1000.0)
    drawn = resampled(values, 50, np.random.default_rng(0))
    assert drawn.shape == values.shape
    assert np.mean(np.diff(drawn) == 1) > 0.95
    assert not np.array_equal(drawn, values)
