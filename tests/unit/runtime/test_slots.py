"""The ring of one role against a dictionary of all that was reported."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.runtime.loop.slots import FINE, SlotRing, Taken

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
