"""Source time counts, unless it cannot be right."""

import itertools
import logging
import math

import pytest

from agent.runtime.intake.source_clock import SourceClock
from agent.runtime.intake.window import RollingWindow
from connectors.base import Quality
from tests.unit.runtime.loops import START, loop_settings, pushed, sample

DAY = 86400.0
YEARS = 26 * 365.25 * DAY


class Wall:
    """The clock of this machine."""

    def __init__(self):
        self.offset = 0.0
        self.passed = 0.0

    def __call__(self):
        return START + self.passed + self.offset


def seen(times, *, quality=Quality.GOOD, wall=None, pace=1.0):
    """What becomes of samples with these source times (s after START) that arrive ``pace`` s apart."""
    wall = wall or Wall()
    clock = SourceClock("FIC101", DAY, wall)
    got = []
    for each in times:
        checked = clock.checked(sample("pv", each, 1.0, quality), wall.passed)
        got.append(None if checked is None else pytest.approx(checked.time - START, abs=1e-3))
        wall.passed += pace
    return got, clock


@pytest.mark.parametrize("off", [0.0, -7200.0, 40.0, DAY - 100])
def test_a_clock_that_is_off_and_ticks_is_believed(off):
    times = [k + off for k in range(50)]
    got, clock = seen(times)
    assert got == times
    assert (clock.absurd, clock.leaps) == (0, 0)


def test_an_absurd_clock_gives_way_to_this_machines_and_its_differences_stay(caplog):
    times = [k - YEARS + (0.3 if k % 2 else 0.0) for k in range(20)]
    with caplog.at_level(logging.INFO):
        got, clock = seen([*times, *range(20, 40)])
    here = [each.expected for each in got[:20]]
    assert all(k - 0.31 < at <= k + 0.001 for k, at in enumerate(here))
    apart = [b - a for a, b in itertools.pairwise(times[1:])]
    assert [b - a for a, b in itertools.pairwise(here[1:])] == pytest.approx(apart, abs=1e-3)
    assert got[20:] == list(range(20, 40))
    assert clock.absurd == 20
    assert len(caplog.records) == 2  # once when it began, once when it was over


def test_what_waited_somewhere_keeps_its_distances_though_the_clock_is_absurd():
    wall = Wall()
    clock = SourceClock("FIC101", DAY, wall)
    assert clock.checked(sample("pv", -YEARS, 1.0), 0.0).time == START
    wall.passed = 20.0
    late = [clock.checked(sample("pv", k - YEARS, 1.0), 20.0).time - START for k in range(1, 21)]
    assert late == pytest.approx(list(range(1, 21)))


def test_one_time_that_leaps_is_dropped_and_counted():
    got, clock = seen([0, 1, 2, 5000, 4, 5, -3000, 7])
    assert got == [0, 1, 2, None, 4, 5, -3000, 7]  # the window drops what is past
    assert clock.leaps == 1


def test_a_clock_that_is_set_forward_is_followed_after_a_second():
    times = [*range(5), *range(3605, 3615)]
    got, clock = seen(times)
    assert got == [*range(5), None, *range(3606, 3615)]
    assert clock.leaps == 1


def test_silence_is_no_leap():
    wall = Wall()
    clock = SourceClock("FIC101", DAY, wall)
    clock.checked(sample("pv", 0, 1.0), 0.0)
    wall.passed = 3600.0
    assert clock.checked(sample("pv", 3600, 1.0), 3600.0).time == START + 3600


def test_the_clock_of_this_machine_may_be_set():
    wall = Wall()
    got, _ = seen(range(5), wall=wall)
    wall.offset = -3600.0
    assert got == list(range(5))
    clock = SourceClock("FIC101", DAY, wall)
    assert all(clock.checked(sample("pv", k, 1.0), 5.0 + k) is not None for k in range(5, 10))


def test_a_missing_value_that_bears_the_time_of_another_clock_counts_now():
    """The source's clock is 30 s behind this machine's, which stamps what the source would not give."""
    clock = SourceClock("FIC101", DAY, Wall())
    clock.checked(sample("pv", -30.0, 1.0), 100.0)
    bad = clock.checked(sample("op", 2.0, math.nan, Quality.BAD), 102.0)
    assert bad.time == START - 28.0
    true = clock.checked(sample("op", -29.0, math.nan, Quality.BAD), 102.0)
    assert true.time == START - 29.0


def test_a_missing_value_from_a_clock_behind_marks_a_gap_and_does_not_start_the_window_anew():
    window = RollingWindow(loop_settings())
    released = []
    for k in range(60):
        released.append(pushed(window, sample("pv", k, float(k)), float(k)))
        quality = Quality.BAD if 20 <= k < 40 else Quality.GOOD
        at = k - 25 if quality is Quality.BAD else k
        released.append(pushed(window, sample("op", at, 1.0 * k, quality), float(k)))
    (first, second) = [each for each in released if each is not None]
    assert window.counters.clock_steps == 0
    assert all(math.isnan(value) for value in first.op[21:40])
    assert all(math.isfinite(value) for value in second.op[20:])


@pytest.mark.parametrize("time", [math.nan, math.inf, -math.inf, 1e300, -1e20])
def test_what_is_no_time_is_dropped_by_the_window(time):
    clock, window = SourceClock("FIC101", DAY, Wall()), RollingWindow(loop_settings())
    window.push(sample("pv", 0.0, 1.0), 0.0)
    odd = clock.checked(sample("pv", time, 1.0), 0.0)
    assert window.push(odd, 1.0) is None
    assert window.newest == START


def test_a_source_that_alternates_with_every_message_is_logged_seldom(caplog):
    now = [1.7e9]
    clock = SourceClock("FIC101", 86400.0, lambda: now[0])
    with caplog.at_level(logging.INFO):
        for k in range(20_000):
            now[0] = 1.7e9 + k / 20
            clock.checked(sample("pv", now[0] - START if k % 2 else 1.0 - START, 1.0), now[0])
    assert len(caplog.records) <= 4  # of a thousand seconds
