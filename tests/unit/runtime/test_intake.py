"""ValueRows that are taken in at once leave the same as their values one by one."""

import math
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.runtime.intake.gathering import ROWS, Gathering, LoopColumns
from agent.runtime.intake.intake import Intake
from agent.runtime.intake.source_clock import SourceClock
from agent.runtime.intake.window import RollingWindow
from agent.runtime.samples.recorder import SampleRecorder
from agent.settings import WindowSettings
from connectors.base import LoopRole, Sample
from connectors.readings import Readings
from tests.unit.runtime.loops import START, loop_settings

ROLES = ("pv", "op", "sp", "mode")
TAGS = tuple(LoopRole("FIC101", role) for role in ROLES)
DAY = 86_400.0
STEPS = st.one_of(
    st.just(1.0),
    st.floats(0.9, 1.1),
    st.sampled_from([0.0, 0.2, 0.5, 1.5, 2.0, 7.3, 30.0, 90.0, -1.0, -20.0, -70.0, 3 * DAY]),
)
VALUES = st.one_of(
    st.floats(0.0, 100.0), st.just(50.0), st.sampled_from([math.nan, math.inf, 1e300, 0.0, 1.0])
)
LATE = st.sampled_from([0.0, 0.0, 0.0, 0.01, 65.0])


class Loop:
    """An intake, its wall clock and what came due."""

    def __init__(self, *, seconds=40.0, clock=True, kept=False):
        self.now = 0.0
        self.due = []
        options = loop_settings(
            roles=ROLES, window=WindowSettings(seconds=seconds, hop=0.25), automatic=(1.0,)
        )
        clocks = SourceClock("FIC101", DAY, lambda: START + self.now) if clock else None
        self.recorder = SampleRecorder(Path("none.sqlite"), 1.0) if kept else None
        self.intake = Intake(options, self._came_due, clocks, self.recorder)
        self.gathering = self._gathering(TAGS)
        self._of_some = {tags: self._gathering(tags) for tags in (TAGS[:2], TAGS[:1], TAGS[1:3])}
        """Those of only some roles, which other readings may have."""

    def _came_due(self, stretch, at):
        self.due.append((self.intake.window.cut(stretch).open(), at))

    def _gathering(self, tags):
        roles = tuple(tag.role for tag in tags)
        return Gathering(tags, [LoopColumns(self.intake, tags, roles, slice(0, len(roles)))])

    def put(self, readings, arrival):
        self.now = arrival
        self._of_some.get(readings.tags, self.gathering).put(readings, arrival)

    def push(self, readings, arrival):
        self.now = arrival
        for each in readings.samples():
            self.intake.push_one(each, arrival)

    def state(self):
        """All that can be seen of it, and the rings to the last byte."""
        self.intake.settle()
        window, clock = self.intake.window, self.intake.clock
        origin, columns = window.recent()
        return {
            "recent": (origin, {role: column.tolist() for role, column in columns.items()}),
            "newest": (window.newest, window.arrival, self.intake.heard),
            "counters": asdict(window.counters),
            "apart": window.clocks.apart,
            "problem": self.intake.usable.problem(self.now, 0.0, 5.0),
            "rings": {
                role: (ring._values.tobytes(), ring._reports.tobytes(), ring._before, ring.first, ring.time)
                for role, ring in window._rings.items()
            },
            "due": [(each.start, at, *_columns(each)) for each, at in self.due],
            "kept": self.recorder and self._kept(self.recorder),
            "clock": clock and (clock._any, clock._roles, clock.absurd, clock.leaps),
        }

    def _kept(self, recorder):
        """By minute: when something came last, and all values. Late ones may make a minute of their own."""
        minutes = [*recorder._over, *(each for some in recorder._open.values() for each in some)]
        touched, values = {}, {}
        for each in minutes:
            table = each.table()
            touched[each.number] = max(each.touched, touched.get(each.number, 0.0))
            for role, column in [*table.columns.items(), ("mode", table.mode), ("quality", table.quality)]:
                there = zip(table.at.tolist(), () if column is None else column, strict=column is not None)
                values |= {(each.number, role, at): str(value) for at, value in there}
        return sorted(touched.items()), sorted(values.items())


def _columns(window):
    return [window.pv.tobytes(), window.op.tobytes(), window.clocks_apart, window.duplicates]


def readings(time, values, tags=TAGS):
    return Readings(tags, START + time, np.array(values)[[TAGS.index(tag) for tag in tags]])


def same(one, other):
    """Compare with NaN equal to itself, as in their texts."""
    return repr(one) == repr(other)


OF_ROLES = st.sampled_from([TAGS, TAGS, TAGS, TAGS[:2], TAGS[:1], TAGS[1:3]])
ROW = st.tuples(STEPS, LATE, st.tuples(*[VALUES] * len(ROLES)), st.integers(0, 40), OF_ROLES)


@settings(max_examples=150, deadline=None)
@given(st.lists(ROW, min_size=1, max_size=40), st.booleans(), st.integers(3, 9), st.booleans())
def test_rows_leave_what_values_leave_one_by_one(rows, clock, repeated, kept):
    many, single = Loop(clock=clock, kept=kept), Loop(clock=clock, kept=kept)
    source = arrival = 0.0
    for k, (step, late, values, look, tags) in enumerate(rows):
        for again in range(repeated):  # mostly as it should be, between two oddities
            source += step if again == 0 else 1.0
            arrival += 1.0 + (late if again == 0 else 0.0)
            shown = values if again == 0 else [50.0 + k, 40.0 + again, 45.0, 1.0]
            each = readings(source, shown, tags if again % 2 == 0 or k % 3 else TAGS)
            many.put(each, arrival)
            single.push(each, arrival)
        if look == 0:
            many.intake.settle()  # as the pipeline does whenever its window is looked at
            many.intake.window.interrupt()
            single.intake.window.interrupt()
        if look < 4:
            assert same(many.state(), single.state())
    assert same(many.state(), single.state())


def test_usual_rows_are_taken_at_once(monkeypatch):
    pushed = []
    push = RollingWindow.push
    monkeypatch.setattr(RollingWindow, "push", lambda *args: pushed.append(args) or push(*args))
    loop = Loop(seconds=4000.0)
    for k in range(10 * ROWS):
        loop.put(readings(k + 0.1 * math.sin(k), [50.0 + k, 40.0, 45.0, 1.0]), float(k))
    loop.intake.settle()
    assert loop.intake.window.counters.samples == 10 * ROWS * len(ROLES)
    assert len(pushed) <= 2 * len(ROLES) + 1, "the first rows alone, until the grid has its origin"


@pytest.mark.parametrize("k", [120, 121, 150])
def test_a_window_comes_due_with_the_row_that_ends_it(k):
    """Not when somebody looks, and not up to ``ROWS`` later."""
    loop = Loop(seconds=float(k))
    for row in range(k - 1):
        loop.put(readings(float(row), [50.0 + row, 40.0, 45.0, 1.0]), float(row))
    assert not loop.due
    loop.put(readings(float(k - 1), [50.0, 40.0, 45.0, 1.0]), float(k - 1))
    ((window, at),) = loop.due
    assert (len(window.pv), at) == (k, k - 1)


def test_what_waits_is_bounded():
    loop = Loop(seconds=4000.0)
    for k in range(1000):
        loop.put(readings(float(k), [50.0, 40.0, 45.0, 1.0]), float(k))
        assert len(loop.gathering._times) < ROWS


def test_where_raw_samples_are_kept_rows_wait_for_seconds_only():
    loop = Loop(seconds=4000.0, kept=True)
    for k in range(300):
        loop.put(readings(float(k), [50.0, 40.0, 45.0, 1.0]), float(k))
        assert len(loop.gathering._times) <= 10
    over = [each.number for each in loop.recorder._over]
    assert over == sorted(set(over))


def test_a_sample_comes_after_the_rows_before_it():
    loop = Loop(seconds=4000.0)
    for k in range(5):
        loop.put(readings(float(k), [50.0 + k, 40.0, 45.0, 1.0]), float(k))
    loop.intake.push(Sample.measured(TAGS[0], START + 5.0, 99.0), 5.0)
    _, columns = loop.intake.window.recent()
    assert columns["pv"].tolist() == [50.0, 51.0, 52.0, 53.0, 54.0, 99.0]


def test_a_server_that_is_slower_than_the_loop_leaves_gaps_between_its_values():
    loop = Loop(seconds=40.0)
    for k in range(14):
        loop.put(readings(3.0 * k, [50.0 + k, 40.0, 45.0, 1.0]), 3.0 * k)
    ((window, _),) = loop.due
    known = np.flatnonzero(np.isfinite(window.pv))
    assert np.array_equal(known % 3, np.zeros(len(known)))
    assert len(known) == pytest.approx(len(window.pv) / 3, abs=1)
