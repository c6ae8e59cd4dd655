"""The ring of one role against a dictionary of all that was reported."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.runtime.intake.rows import FINE, GridPlaces
from agent.runtime.intake.slots import SlotRing, Taken

CAPACITY = 8
STEPS = st.lists(st.tuples(st.integers(0, 2 * FINE) | st.integers(0, 20 * FINE), st.booleans()), max_size=40)
"""Times that pass, some longer than the whole ring, and whether the connection is lost before."""


@given(STEPS, st.integers(-3, 3))
@settings(max_examples=200, deadline=None)
def test_it_has_what_was_reported_and_what_holds_of_it(steps, origin):
    ring, values, reports, unknown = SlotRing(CAPACITY), {}, {}, None
    at = origin * FINE
    for k, (step, lost) in enumerate(steps):
        if lost and values:
            ring.interrupt(ring.newest + 1)
            unknown = max(values) + 1 if unknown is None else unknown
        at += step
        taken = ring.put(float(at), at / FINE, float(k))
        assert taken is (Taken.DUPLICATE if values and not step else Taken.NEW)
        slot = round(at / FINE)
        if taken is Taken.NEW:
            if unknown is not None and slot > unknown:
                values[unknown] = np.nan
            values[slot], reports[slot] = float(k), at
        unknown = None
    if not reports:
        assert ring.reports().size == 0
        return
    newest = max(reports)
    within = [reports[slot] for slot in sorted(reports) if slot > newest - CAPACITY]
    before = [reports[slot] for slot in sorted(reports) if slot <= newest - CAPACITY]
    assert ring.reports().tolist() == [*before[-1:], *within]
    held, expected = np.nan, []
    for slot in range(min(values), newest + 4):
        held = values.get(slot, held)
        expected.append(held)
    expected = expected[-CAPACITY - 3 :]
    np.testing.assert_array_equal(ring.column(newest + 4 - len(expected), len(expected)), expected)


@given(
    st.lists(st.lists(st.sampled_from([0.2, 0.6, 1.0, 1.0, 1.4, 3.0]), min_size=1, max_size=7), max_size=9)
)
def test_many_at_once_leave_the_same_ring(runs):
    """Also where the ring has been filled several times over, and what it lost is remembered."""
    one, other = SlotRing(8), SlotRing(8)
    time = 0.0
    for each in (one, other):
        each.put(time, time, -1.0)
    for steps in runs:
        times = time + np.cumsum(steps)
        time = float(times[-1])
        places = GridPlaces(times, 0.0, 1.0)
        if other.can_take(places):
            other.take(places, np.concatenate([[np.nan], times]).astype(np.float32))
        else:
            for at in times.tolist():
                other.put(at, at, at)
        for at in times.tolist():
            one.put(at, at, at)
        assert _state(one) == _state(other)


def _state(ring):
    return ring._values.tobytes(), ring._reports.tobytes(), ring._before, ring.first, ring.newest, ring.time
