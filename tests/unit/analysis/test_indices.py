"""Performance indices on records whose value is known."""

import numpy as np
import pytest

from agent.analysis.indices import INDICES, performance
from agent.analysis.record.recording import LoopHints, LoopWindow

N = 3600
T = np.arange(N)
RNG = np.random.default_rng(3)


def window(op=None, pv=None, sp=None, automatic=None, hints=None, ts=1.0):
    op = 50 + 10 * np.sin(2 * np.pi * T / 60) if op is None else op
    pv = np.full(N, 100.0) if pv is None else pv
    return LoopWindow("FIC101", 0.0, ts, op, pv, sp, None, automatic, hints or LoopHints())


def test_every_index_has_a_name_of_its_own_a_meaning_and_a_source():
    assert len({each.name for each in INDICES}) == len(INDICES)
    for each in INDICES:
        assert each.meaning
        assert type(each).__doc__


def test_error_and_crossings_of_a_known_error():
    pv = 100 + 3 * np.sin(2 * np.pi * T / 60)
    found = performance(window(pv=pv, sp=np.full(N, 100.0)), None)
    assert found["mean_absolute_error"] == pytest.approx(3 * 2 / np.pi, rel=1e-3)
    assert found["set_point_crossings"] == pytest.approx(120, abs=2)
    assert found["variability"] == pytest.approx(2 * 3 / np.sqrt(2), rel=1e-3)


def test_travel_and_reversals_of_a_triangle():
    triangle = 40 + 20 * np.abs((T / 60) % 2 - 1)
    found = performance(window(op=triangle), None)
    assert found["travel"] == pytest.approx(3600 * 20 / 60, rel=1e-6)
    assert found["reversals"] == pytest.approx(59, abs=1)


def test_shares_of_time():
    automatic = T >= N // 4
    op = np.where(T >= N - 3 * N // 40, 100.0, 50 + np.sin(T))
    found = performance(window(op=op, automatic=automatic, hints=LoopHints(op_range=(0.0, 100.0))), None)
    assert found["time_in_manual"] == pytest.approx(25)
    assert found["service_factor"] == pytest.approx(75)
    assert found["saturation"] == pytest.approx(10)


@pytest.mark.parametrize("delay", [1, 5, 20])
def test_harris_is_one_where_the_error_is_that_of_minimum_variance(delay):
    noise = RNG.standard_normal(20_000)
    moving = np.convolve(noise, np.ones(delay), "valid")
    assert performance(window(op=moving, pv=moving), float(delay))["harris"] == pytest.approx(1.0, abs=0.03)


def test_harris_is_small_where_the_loop_oscillates_and_unknown_without_a_delay():
    pv = np.sin(2 * np.pi * T / 60) + 0.1 * RNG.standard_normal(N)
    assert performance(window(pv=pv), 5.0)["harris"] < 0.1
    assert performance(window(pv=pv), None)["harris"] is None


def test_what_a_record_does_not_determine_is_none_and_gaps_do_no_harm():
    found = performance(window(), None)
    for name in ("mean_absolute_error", "service_factor", "saturation", "set_point_crossings"):
        assert found[name] is None
    gappy = np.where(T % 5 == 0, np.nan, 50 + 10 * np.sin(T / 9))
    nothing = np.full(N, np.nan)
    for op, pv in ((gappy, gappy), (nothing, nothing), (gappy[:2], gappy[:2])):
        for value in performance(window(op=op, pv=pv, sp=pv), 3.0).values():
            assert value is None or np.isfinite(value)
