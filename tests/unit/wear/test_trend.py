"""S against time: wear, repairs, bounds, short days, outliers, and limits; simulated valves by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.memory.s_day import SDay
from agent.analysis.wear.filter import COMMON, SHORT
from agent.analysis.wear.trend import DAY, reaches, trend_of

START = 1.7e9
NOISE = 0.15


def days(levels, seed=0, every=1.0):
    rng = np.random.default_rng(seed)
    return [
        SDay(
            START + k * every * DAY, max(s * (1 + NOISE * rng.standard_normal()), 0.0), NOISE * s + 0.02, 1.0
        )
        for k, s in enumerate(levels)
    ]


def wearing(seed):
    return days(np.geomspace(1.0, 4.0, 28), seed)


def test_wear_from_1_to_4_is_seen_with_the_right_sign_of_its_slope():
    found = [trend_of(wearing(seed)) for seed in range(40)]
    assert sum(each.slope > 0 for each in found) >= 38
    assert sum(each.worse_since is not None for each in found) >= 34
    assert all(each.repaired is None for each in found)


def test_a_repair_is_noticed_within_three_days():
    noticed = 0
    for seed in range(40):
        record = days([4.0] * 25 + [0.2] * 3, seed)
        found = trend_of(record)
        noticed += found.repaired is not None and abs(found.repaired - record[25].time) <= DAY
    assert noticed >= 38


def test_a_constant_valve_is_neither_repaired_nor_worse():
    found = [trend_of(days([3.0] * 40, seed)) for seed in range(40)]
    assert sum(bool(each.jumps) for each in found) <= 1
    assert sum(each.worse_since is not None for each in found) <= 3


def test_the_interval_holds():
    inside = []
    for seed in range(40):
        last = trend_of(days([3.0] * 30, seed)).levels[-1]
        inside.append(last.low <= 3.0 <= last.high)
    assert 0.8 <= np.mean(inside) <= 1.0


def test_the_interval_holds_where_all_windows_of_a_valve_are_wrong_in_the_same_way():
    inside, widths = [], []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        common = SHORT + COMMON * rng.standard_normal()
        seen = 3.0 * np.exp(-0.12 * (common + 0.35 * rng.standard_normal(12)))
        levels = trend_of([SDay(START + k * DAY, float(s), 0.12 * s, 1.0) for k, s in enumerate(seen)]).levels
        inside += [each.low <= 3.0 <= each.high for each in levels]
        widths.append(math.log(levels[-1].high / levels[-1].low))
    assert 0.85 <= np.mean(inside) <= 1.0
    assert np.median(widths) < 0.3


def bounds(values, after=0.0):
    """Return days that show no more than that S is at most each of ``values``."""
    times = [START + (after + k) * DAY for k in range(len(values))]
    return [
        SDay(time, each / 2, each / 4, 1.0, above=math.log(0.05))
        for time, each in zip(times, values, strict=True)
    ]


def test_a_repair_is_seen_by_bounds_alone():
    found = trend_of([*days([4.0] * 15), *bounds([0.5] * 3, after=15)])
    assert [each.repair for each in found.jumps] == [True]
    assert found.repaired == START + 15 * DAY
    assert found.levels[-1].low == 0.0
    assert trend_of([*days([4.0] * 15), *bounds([0.5] * 4, after=15)]).levels[-1].high < 1.0


def divided(above, at=1.5, after=0.0):
    """Return days that are compared, each likelier by as many nats where S is above ``at``."""
    times = [START + (after + k) * DAY for k in range(len(above))]
    return [SDay(time, at, 0.0, 1.0, 0.0, at, each) for time, each in zip(times, above, strict=True)]


def recognised(levels, agrees=3.0):
    """Return days that show S, and are compared as well."""
    return [replace(each, half=2.0, agrees=agrees) for each in days(levels)]


def test_two_clear_days_show_a_repair_and_three_days_of_three_nats_do():
    for evidence in ([-5.0] * 2, [-3.0] * 3):
        found = trend_of([*recognised([4.0] * 15), *divided(evidence, after=15)])
        assert found.repaired == START + 15 * DAY
        assert found.levels[-1].low == 0.0
        assert 0.3 < found.levels[-1].high < 4.0
    for too_little in ([-5.0], [-2.0, 2.0, -2.0, -2.0]):
        assert trend_of([*recognised([4.0] * 15), *divided(too_little, after=15)]).jumps == ()


def test_a_day_that_is_not_enough_for_a_repair_opens_the_interval():
    """S may be the former one or next to nothing: the interval has both, its middle is the likelier one."""
    known, seen = recognised([4.0] * 15), trend_of([*recognised([4.0] * 15), *divided([-4.5], after=15)])
    assert seen.repaired is None
    assert trend_of(known).levels[-1].low > 3.0
    assert seen.levels[-1].low == 0.0
    assert 3.5 < seen.levels[-1].s < 4.5 < seen.levels[-1].high + 0.5


def test_s_that_is_shown_again_closes_it():
    shown = [replace(each, time=each.time + 16 * DAY) for each in recognised([4.0] * 3)]
    level = trend_of([*recognised([4.0] * 15), *divided([-4.5], after=15), *shown]).levels[-1]
    assert 3.0 < level.low < 4.0 < level.high < 5.3


def test_a_jump_that_may_have_come_on_several_days_is_as_probable_as_these_together():
    known, twice = recognised([4.0] * 15), [-3.05, -3.05]
    assert trend_of([*known, *divided(twice, after=15)]).repaired is None
    assert trend_of([*known, *divided([0.0] * 5 + twice, after=15)]).repaired is not None


def test_what_all_windows_of_a_valve_may_have_in_common_does_not_average_away():
    few, many = (trend_of(days([4.0] * n)).levels[-1] for n in (30, 120))
    assert math.log(many.high / many.low) > 0.7 * math.log(few.high / few.low)
    assert math.log(many.high / many.low) > 0.15


def test_days_say_nothing_where_the_valve_was_never_recognised_or_contradicted_before():
    for before in (days([4.0] * 15), recognised([4.0] * 15, agrees=-5.0)):
        found = trend_of([*before, *divided([-5.0] * 10, after=15)])
        assert found.repaired is None
        assert found.levels[-1].low > 1.5


def test_quiet_days_recognise_a_valve_as_days_that_show_s_do():
    found = trend_of([*days([4.0] * 8), *divided([3.0] * 3, after=8), *divided([-5.0] * 2, after=11)])
    assert found.repaired == START + 11 * DAY


def test_a_level_that_is_not_sure_does_not_slide_below_the_former_s():
    """A slope that is not known yet must not explain a repair: S does not fall by itself."""
    unsure = [SDay(START + k * DAY, 2.0, 0.5, 1.0, None, 1.0, 3.0) for k in range(0, 9, 2)]
    found = trend_of([*unsure, *divided([-5.0] * 3, at=1.0, after=16)])
    assert found.repaired == START + 16 * DAY
    assert found.levels[-1].low == 0.0


def test_days_on_which_the_valve_sticks_as_before_take_a_repair_back_and_move_nothing_else():
    known = recognised([4.0] * 15)
    assert trend_of([*known, *divided([-5.0] * 2, after=15)]).repaired is not None
    assert trend_of([*known, *divided([-5.0] * 2, after=15), *divided([3.0] * 3, after=17)]).repaired is None
    still = trend_of([*known, *divided([3.0] * 10, after=15)])
    nothing = trend_of([*known, *divided([0.0] * 10, after=15)])
    assert still.levels[-1].s == pytest.approx(nothing.levels[-1].s, rel=0.03)
    assert still.levels[-1].low > 0.9 * nothing.levels[-1].low


def test_bounds_above_s_say_nothing_and_many_say_no_more_than_one():
    above, nothing = (
        trend_of([*days([4.0] * 15), *more])
        for more in (bounds([9.0] * 10, after=15), divided([0.0] * 10, at=9.0, after=15))
    )
    now, then = above.levels[-1], nothing.levels[-1]
    assert (now.s, now.low, now.high) == pytest.approx((then.s, then.low, then.high), rel=0.03)
    few, many = (trend_of(bounds([2.0] * n)).levels[-1] for n in (3, 30))
    assert many.high > 0.7 * few.high > 1.0


def test_one_wrong_day_moves_nothing():
    levels = np.full(30, 3.0)
    record = days(levels)
    record[20] = SDay(record[20].time, 9.0, 0.3, 1.0)
    found = trend_of(record)
    assert found.jumps == ()
    assert found.levels[-1].s == pytest.approx(3.0, rel=0.15)


def test_a_limit_is_reached_at_the_time_that_the_slope_gives():
    found = trend_of(days(np.geomspace(1.0, 4.0, 31)))
    at = reaches(found, 6.0)
    assert at.low < at.time
    assert (at.time - START) / DAY == pytest.approx(30 * np.log(6) / np.log(4), abs=4)
    assert reaches(found, 0.5).time == pytest.approx(START + 30 * DAY)
    assert reaches(trend_of(days([3.0] * 30)), 1000.0).time is None


def test_a_repair_begins_a_new_trend():
    found = trend_of(days([*np.linspace(2.0, 5.0, 20), *np.linspace(0.5, 1.0, 20)]))
    assert [each.repair for each in found.jumps] == [True]
    assert found.levels[-1].s == pytest.approx(1.0, rel=0.2)
    assert found.slope > 0


def test_two_days_are_no_trend():
    assert trend_of(days([1.0, 2.0])) is None
