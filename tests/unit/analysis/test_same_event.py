"""One event recorded twice is known for one; two days of one loop are not."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.same_event import A_DATE, correlations, one_of_each, same_event

N = 800
DAY = 86_400.0


def loop(seed, *, start=0.0, ts=1.0, name="FIC101"):
    """OP that wanders, steps once and is noisy."""
    rng = np.random.default_rng(seed)
    op = 50 + np.cumsum(rng.normal(size=N)) * 0.2 + 0.1 * rng.normal(size=N)
    op[rng.integers(N // 4, 3 * N // 4) :] += 4.0
    return LoopWindow(name, start, ts, op=op, pv=op)


def part(window, begin, end, *, later=0.0, name="FIC101_2"):
    """The same event again, from sample ``begin`` to ``end``, sampled ``later`` samples later."""
    at = np.arange(begin, end) + later
    op = np.interp(at, np.arange(len(window)), window.op)
    return LoopWindow(name, 7.0, window.ts, op=op, pv=op)


@pytest.mark.parametrize(
    ("begin", "end", "later"), [(0, N, 0.0), (80, N, 0.0), (0, 500, 0.5), (300, 700, 0.3)]
)
def test_one_event_moved_in_time_is_one(begin, end, later):
    window = loop(0)
    assert same_event(window, part(window, begin, end, later=later))
    assert same_event(part(window, begin, end, later=later), window)


@pytest.mark.parametrize("other", range(1, 6))
def test_two_days_are_two(other):
    assert not same_event(loop(0), loop(other))


def test_two_ramps_are_two_though_their_levels_are_alike():
    rise, (first, second) = np.linspace(0, 30, N), np.random.default_rng(0).normal(size=(2, N))
    one, other = (LoopWindow("FIC101", 0.0, 1.0, op=rise + each, pv=rise) for each in (first, second))
    assert correlations(one.op, other.op).max() > 0.98
    assert not same_event(one, other)


def test_two_answers_to_a_step_of_the_set_point_are_two():
    def day(seed):
        noise = 0.02 * np.random.default_rng(seed).normal(size=N)
        op = 50 + 5 * (np.arange(N) > 400) + np.cumsum(noise)
        return LoopWindow("FIC101", 0.0, 1.0, op=op, pv=op)

    assert not same_event(day(0), day(1))


def test_less_than_half_in_common_reports_nothing_unless_dated():
    window = loop(0)
    assert not same_event(part(window, 0, 450), part(window, 350, N))


def test_dates_that_overlap_make_one_event():
    first, later = loop(0, start=20_000 * DAY), loop(1, start=20_000 * DAY + N / 2)
    assert same_event(first, later)
    assert not same_event(first, loop(1, start=20_000 * DAY + N - 1))
    assert not same_event(loop(0), loop(1, start=N / 2)), "a clock that begins with the file is no date"
    assert 20_000 * DAY > A_DATE


def test_gaps_and_other_sampling_times_hide_no_event():
    window = loop(0)
    holes = np.array(window.op)
    holes[100:140] = np.nan
    assert same_event(window, LoopWindow("FIC101", 0.0, 1.0, op=holes, pv=holes))
    slow = LoopWindow("FIC101", 0.0, 2.0, op=window.op[::2], pv=window.op[::2])
    assert same_event(window, slow)


@pytest.mark.parametrize("length", [1, 3, 10, N])
def test_what_does_not_move_is_like_nothing(length):
    still = LoopWindow("FIC101", 0.0, 1.0, op=np.full(length, 42.0), pv=np.zeros(length))
    assert not same_event(still, loop(0))
    assert not same_event(still, still)


def test_the_longest_stands_for_its_event():
    window, other = loop(0), loop(1)
    shorter = part(window, 0, 600)
    assert one_of_each([shorter, other, window]) == [2, 1, 2]
    assert one_of_each([window, shorter, other]) == [0, 0, 2]
    assert one_of_each([]) == []


def test_correlation_is_that_of_the_overlap():
    rng = np.random.default_rng(0)
    one, other = rng.normal(size=60), rng.normal(size=40)
    slow = max(
        np.corrcoef(one[max(0, k) : min(60, 40 + k)], other[max(0, -k) : min(40, 60 - k)])[0, 1]
        for k in range(-20, 41)
    )
    assert correlations(one, other).max() == pytest.approx(slow)
