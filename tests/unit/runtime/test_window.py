"""Hold or gap: what a bus did not say is held where nothing changed and missing where nobody knows."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.runtime.intake.window import CLOCK_SET_BACK, LATEST, RollingWindow
from agent.settings import WindowSettings
from connectors.base import Quality
from tests.unit.runtime.loops import START, both, loop_settings, push_all, pushed, sample


def test_a_window_is_due_when_it_is_full_and_then_each_hop():
    windows = push_all(RollingWindow(loop_settings(seconds=40.0, hop=0.5)), both(range(100)))
    assert [w.start - START for w in windows] == [0.0, 20.0, 40.0, 60.0]
    assert {len(w) for w in windows} == {40}
    np.testing.assert_array_equal(windows[1].pv, np.arange(20.0, 60.0))
    np.testing.assert_allclose(windows[1].op, np.arange(20.0, 60.0) / 10)


def test_nothing_is_requested_of_the_order_in_which_the_roles_arrive():
    """OPC UA may send twenty values of PV and then twenty of OP."""
    in_time = push_all(RollingWindow(loop_settings()), both(range(100)))
    window, grouped = RollingWindow(loop_settings()), []
    for start in range(0, 100, 20):
        grouped += [sample("pv", t, float(t)) for t in range(start, start + 20)]
        grouped += [sample("op", t, t / 10) for t in range(start, start + 20)]
    by_role = push_all(window, grouped)
    assert len(by_role) == len(in_time)
    for one, other in zip(in_time, by_role, strict=True):
        np.testing.assert_array_equal(one.pv, other.pv)
        np.testing.assert_array_equal(one.op, other.op)


def test_rows_that_all_roles_miss_are_a_gap_where_they_are_reported_together():
    (window,) = push_all(RollingWindow(loop_settings()), both([*range(10), *range(13, 40)]))
    assert np.flatnonzero(np.isnan(window.pv)).tolist() == [10, 11, 12]
    assert np.flatnonzero(np.isnan(window.op)).tolist() == [10, 11, 12]


def test_a_role_that_is_silent_while_another_speaks_holds():
    samples = [sample("op", 0, 7.0), *(sample("pv", t, float(t)) for t in range(40 + LATEST))]
    windows = push_all(RollingWindow(loop_settings()), samples)
    np.testing.assert_array_equal(windows[0].op, np.full(40, 7.0))
    assert np.isfinite(windows[0].pv).all()


def test_where_changes_only_are_reported_a_short_silence_is_no_change_and_a_long_one_a_gap():
    settings = loop_settings(hold=5.0)
    samples = [sample("op", 0, 7.0), *(sample("pv", t, float(t)) for t in [*range(10), *range(14, 20)])]
    samples += [sample("pv", t, float(t)) for t in range(26, 40 + LATEST)]
    window = push_all(RollingWindow(settings), samples)[0]
    np.testing.assert_array_equal(window.pv[10:14], [9.0] * 4)
    assert np.flatnonzero(np.isnan(window.pv)).tolist() == list(range(20, 26))
    assert np.flatnonzero(np.isnan(window.op)).tolist() == list(range(20, 26))


def test_a_bad_value_is_missing_until_the_next_good_one_and_an_uncertain_one_is_kept():
    samples = list(both(range(40)))
    samples[20] = sample("pv", 10, 99.0, Quality.BAD)
    samples[22] = sample("pv", 11, 11.0, Quality.UNCERTAIN)
    rolling = RollingWindow(loop_settings())
    (window,) = push_all(rolling, samples)
    assert np.flatnonzero(np.isnan(window.pv)).tolist() == [10]
    assert window.pv[11] == 11.0
    assert (rolling.counters.bad, rolling.counters.uncertain, rolling.counters.missing) == (1, 1, 1)


def test_a_server_that_waits_for_its_first_value_does_not_set_the_clock():
    waiting = [sample(role, 1e8, 0.0, Quality.BAD) for role in ("pv", "op")]
    (window,) = push_all(RollingWindow(loop_settings()), [*waiting, *both(range(40))])
    assert np.isfinite(window.pv).all()


def test_a_bad_value_that_is_not_reported_again_stays_missing():
    samples = [*both(range(10)), sample("pv", 10, 99.0, Quality.BAD)]
    samples += [sample("op", t, t / 10) for t in range(10, 40 + LATEST)]
    window = push_all(RollingWindow(loop_settings()), samples)[0]
    assert np.isnan(window.pv[10:]).all()
    assert np.isfinite(window.op).all()


def test_what_nobody_heard_while_the_connection_was_gone_is_a_gap():
    rolling = RollingWindow(loop_settings(roles=("pv", "op", "sp")))
    push_all(rolling, [sample("sp", -5, 50.0), *both(range(10))])
    rolling.interrupt()
    rolling.interrupt()
    after = [
        sample("sp", -5, 50.0),
        *both(range(12, 40 + LATEST)),
    ]  # the server tells all anew; SP is the same
    window = push_all(rolling, after)[0]
    assert np.flatnonzero(np.isnan(window.pv)).tolist() == [10, 11]
    assert np.flatnonzero(np.isnan(window.op)).tolist() == [10, 11]
    assert window.sp is not None
    np.testing.assert_array_equal(window.sp[12:], np.full(28, 50.0))


def test_a_set_point_that_is_not_reported_again_after_an_interruption_is_unknown():
    rolling = RollingWindow(loop_settings(roles=("pv", "op", "sp")))
    push_all(rolling, [sample("sp", -5, 50.0), *both(range(20))])
    rolling.interrupt()
    window = push_all(rolling, both(range(20, 40 + LATEST)))[0]
    assert window.sp is not None
    assert np.flatnonzero(np.isnan(window.sp)).tolist() == list(range(20, 40))
    assert np.isfinite(window.pv).all()


def test_a_set_point_that_changed_days_ago_does_not_stretch_the_window():
    samples = [sample("sp", -3 * 86400.3, 50.0), sample("op", -86400.0, 0.0), *both(range(40))]
    windows = push_all(RollingWindow(loop_settings(roles=("pv", "op", "sp"))), samples)
    assert len(windows) == 1
    assert windows[0].start == START
    np.testing.assert_array_equal(windows[0].sp, np.full(40, 50.0))


def test_duplicates_and_samples_from_the_past_are_dropped_and_counted():
    samples = list(both(range(40)))
    samples[30:30] = [sample("pv", 14, -1.0), sample("op", 3, -1.0), sample("pv", 14, -2.0)]
    rolling = RollingWindow(loop_settings())
    (window,) = push_all(rolling, samples)
    np.testing.assert_array_equal(window.pv, np.arange(40.0))
    assert (rolling.counters.duplicates, rolling.counters.backward) == (2, 1)
    assert window.duplicates == 2


@pytest.mark.parametrize("step", [-3600.0, 5e9])
def test_a_source_clock_that_is_set_costs_a_window_and_not_the_loop(step):
    rolling = RollingWindow(loop_settings())
    push_all(rolling, [*both(range(60)), *both([60 + max(step, 0.0)])])
    back = min(step, 0.0)
    windows = push_all(rolling, both(np.arange(60, 60 + CLOCK_SET_BACK + 80) + back))
    assert rolling.counters.clock_steps == 1
    assert np.isfinite(windows[-1].pv).all()
    assert windows[-1].start < START + 60 + CLOCK_SET_BACK + 80


def test_a_poll_that_is_slightly_slow_makes_no_gap():
    """Every now and then a slot stays empty although nothing was missed."""
    (window, *_) = push_all(RollingWindow(loop_settings()), both(np.arange(60) * 1.04))
    assert np.isfinite(window.pv).all()


def test_jitter_does_not_move_samples():
    times = np.arange(40) + np.where(np.arange(40) % 2, 0.3, -0.1)
    (window,) = push_all(RollingWindow(loop_settings()), both(times))
    np.testing.assert_array_equal(window.pv, times.astype(np.float32))


def test_mode_says_where_the_loop_was_automatic():
    settings = loop_settings(roles=("pv", "op", "mode"), automatic=("auto", 1))
    modes = {0: "AUTO", 10: "MAN", 20: 1.0, 30: 2.0}
    samples = []
    for t in range(40 + LATEST):
        samples += [*([sample("mode", t, modes[t])] if t in modes else []), *both([t])]
    window = push_all(RollingWindow(settings), samples)[0]
    assert window.automatic is not None
    assert window.automatic.tolist() == [True] * 10 + [False] * 10 + [True] * 10 + [False] * 10


def test_roles_that_are_configured_but_never_reported_are_unknown():
    (window,) = push_all(
        RollingWindow(loop_settings(roles=("pv", "op", "sp", "mv", "mode"))), both(range(40))
    )
    assert (window.sp, window.mv, window.automatic) == (None, None, None)


def test_what_it_cannot_use_does_no_harm():
    rolling = RollingWindow(loop_settings())
    odd = [sample("sp", 0, 1.0), sample("pv", float("nan"), 1.0), sample("pv", 0, "text")]
    assert push_all(rolling, odd) == []
    assert rolling.newest == START


def test_length_follows_the_period_once_one_is_known():
    window = WindowSettings(periods=4, min_seconds=40.0, max_seconds=200.0, hop=0.5)
    rolling = RollingWindow(loop_settings(window=window))
    lengths = [len(w) for w in push_all(rolling, both(range(200)))]
    assert lengths == [40, 60, 90, 135, 200][: len(lengths)]
    rolling.period = 20.0
    assert {len(w) for w in push_all(rolling, both(range(200, 400)))} == {80}
    rolling.period = 1000.0
    assert {len(w) for w in push_all(rolling, both(range(400, 600)))} == {200}


def test_it_knows_how_old_its_data_are_by_arrival_and_not_by_source_time():
    rolling = RollingWindow(loop_settings())
    assert rolling.arrival is None
    rolling.push(sample("pv", 1e6, 0.0), arrival=12.0)
    assert rolling.arrival == 12.0


def test_memory_does_not_grow():
    rolling = RollingWindow(loop_settings())
    arrays = {id(a) for ring in rolling._rings.values() for a in (ring._values, ring._reports)}
    push_all(rolling, both(range(1000)))
    assert {id(a) for r in rolling._rings.values() for a in (r._values, r._reports)} == arrays


VALUES = st.one_of(st.floats(), st.sampled_from(["AUTO", "Bad"]))
SAMPLES = st.builds(
    sample,
    st.sampled_from(["pv", "op", "sp", "mode", "other"]),
    st.one_of(st.floats(-100, 300), st.floats(-1e8, 1e8), st.sampled_from([float("nan"), float("inf")])),
    VALUES,
    st.sampled_from(Quality),
)


@given(st.lists(st.one_of(SAMPLES, st.just(None)), max_size=120))
@settings(max_examples=200, deadline=None)
def test_no_stream_of_samples_breaks_it(samples):
    rolling = RollingWindow(loop_settings(roles=("pv", "op", "sp", "mode"), ts=2.0))
    for arrival, each in enumerate(samples):
        if each is None:
            rolling.interrupt()
        else:
            window = pushed(rolling, each, float(arrival))
            assert window is None or len(window) == 20


def naive_hold(events, n):
    """Value at each second: that of the last event not later than it."""
    told = dict(events)
    column = [np.nan]
    for k in range(n):
        column.append(told.get(k, column[-1]))
    return np.array(column[1:])


@given(
    st.lists(
        st.tuples(st.integers(0, 1), st.integers(1, 4), st.sampled_from((-1.0, 0.0, 1.0))),
        min_size=30,
        max_size=80,
    )
)
@settings(deadline=None)
def test_changes_reported_one_by_one_give_what_holding_by_hand_gives(changes):
    times = itertools.accumulate((gap for _, gap, _ in changes))
    told = [("pv", 0, 0.0), ("op", 0, 0.0)]
    told += [(("pv", "op")[role], t, value) for (role, _, value), t in zip(changes, times, strict=True)]
    end = told[-1][1] + LATEST + 2
    told += [("pv", t, 0.0) for t in range(told[-1][1] + 1, end + 1)]  # PV is told more often than OP
    rolling = RollingWindow(loop_settings(seconds=25.0, hop=0.2, hold=1e6))
    released = push_all(rolling, [sample(*each) for each in told])
    assert released
    expected = {
        role: naive_hold([(t, value) for r, t, value in told if r == role], end + 1) for role in ("pv", "op")
    }
    for window in released:
        part = slice(int(window.start - START), int(window.start - START) + len(window))
        np.testing.assert_array_equal(window.pv, expected["pv"][part])
        np.testing.assert_array_equal(window.op, expected["op"][part])
