"""When a window comes due, and what is cut of it once a worker is free."""

from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.diagnosis import RecordSummary
from agent.analysis.record.recording import LoopHints
from agent.analysis.recording_stretches import LONGEST
from agent.runtime.intake.cut import CutWindow
from agent.runtime.intake.window import CLOCK_SET_BACK, LATEST, RollingWindow
from tests.unit.runtime.loops import START, both, loop_settings, push_all


def test_first_windows_of_a_large_plant_come_due_one_after_the_other():
    firsts = [
        push_all(RollingWindow(loop_settings(seconds=40.0, hop=0.5), stagger), both(range(70)))[0]
        for stagger in (0.0, 0.5, 0.99)
    ]
    assert [each.time[-1] - START for each in firsts] == [39.0, 49.0, 58.0]
    assert {len(each) for each in firsts} == {40}


def cut_late(more):
    """A window when it came due, and cut after so many further seconds."""
    rolling, due = RollingWindow(loop_settings()), []
    for arrival, each in enumerate(both(range(60 + more))):
        stretch = rolling.push(each, float(arrival))
        if stretch is not None and not due:
            due += [stretch, rolling.cut(stretch).open()]
    return due[1], rolling.cut(due[0]).open()


def test_a_window_that_is_cut_later_is_the_same_while_the_rings_have_it():
    at_once, later = cut_late(LATEST - 20)
    assert later.start == at_once.start
    for name in ("pv", "op"):
        np.testing.assert_array_equal(getattr(later, name), getattr(at_once, name))


def test_a_window_of_which_the_rings_have_lost_the_begin_is_as_long_and_newer():
    at_once, later = cut_late(500)
    assert len(later) == len(at_once)
    np.testing.assert_array_equal(later.pv, later.time - START)
    assert later.start > at_once.time[-1]


def test_nothing_is_left_of_a_window_whose_clock_was_set_back():
    rolling = RollingWindow(loop_settings())
    due = [found for k, each in enumerate(both(range(40))) if (found := rolling.push(each, float(k)))]
    push_all(rolling, both(np.arange(-5000, -5000 + CLOCK_SET_BACK + 2)))
    assert rolling.counters.clock_steps == 1
    assert rolling.cut(due[0]) is None


def test_of_a_loop_that_is_scanned_ten_times_a_second_the_newest_stretch_is_judged():
    time = START + 0.1 * np.arange(10_800)
    op = 50 + np.sin(time / 2)
    cut = CutWindow("FIC101", START, 0.1, {"op": op, "pv": op}, LoopHints(), 0, 0.0)
    window = cut.open()
    assert len(window) == LONGEST
    record = RecordSummary(len(window), 0, 0, 0.1, 2.0)
    assert window.start == pytest.approx(START + 720.0)
    assert cut.begin_of(record) == pytest.approx(window.start)
    assert cut.begin_of(None) == cut.begin_of(replace(record, samples=10_800)) == START
