import numpy as np

from agent.physics.processes.arx import Arx, simulate_arx

FIRST = Arx(a1=0.8, a2=0.0, b1=0.4, b2=0.0, bias=0.0, delay=3)


def test_a_step_comes_through_after_the_delay_and_ends_at_the_gain():
    mv = np.where(np.arange(80) < 10, 0.0, 1.0)
    model = simulate_arx(FIRST, mv, np.zeros(80))
    assert np.isnan(model[:4]).all(), "before x(t - D) is known the model has nothing to say"
    assert model[12] == 0.0
    assert model[13] == 0.4
    assert abs(model[-1] - 2.0) < 1e-5


def test_the_measured_pv_is_only_where_it_starts_from():
    pv = np.full(80, 7.0)
    model = simulate_arx(FIRST, np.zeros(80), pv)
    assert model[4] == 0.8 * 7.0
    assert abs(model[-1]) < 1e-5


def test_after_a_gap_in_mv_it_starts_again_from_the_measured_pv():
    mv = np.zeros(80)
    mv[40:43] = np.nan
    model = simulate_arx(FIRST, mv, np.full(80, 7.0))
    assert np.flatnonzero(np.isnan(model[5:])).tolist() == [38, 39, 40, 41], "x(t-D) or x(t-D-1) is missing"
    assert model[47] == 0.8 * 7.0


def test_a_gap_in_pv_alone_does_not_stop_it():
    pv = np.full(80, 7.0)
    pv[20:40] = np.nan
    model = simulate_arx(FIRST, np.zeros(80), pv)
    np.testing.assert_array_equal(model, simulate_arx(FIRST, np.zeros(80), np.full(80, 7.0)))


def test_second_order_and_bias():
    process = Arx(a1=1.3, a2=-0.4, b1=0.1, b2=0.05, bias=0.2, delay=1)
    mv, model = np.sin(np.arange(50.0)), np.zeros(50)
    for t in range(2, 50):
        model[t] = 1.3 * model[t - 1] - 0.4 * model[t - 2] + 0.1 * mv[t - 1] + 0.05 * mv[t - 2] + 0.2
    np.testing.assert_allclose(simulate_arx(process, mv, np.zeros(50))[2:], model[2:], atol=1e-12)
