"""In words, the test at the loop that distinguishes effects which a record cannot distinguish."""

from __future__ import annotations

TESTS = {
    "valve_hysteresis": (
        "In manual, step OP in one direction until PV responds, then back in steps of a tenth of S. Behind a "
        "dead band PV follows each step; a valve that sticks stands and then jumps; one whose friction "
        "differs by direction needs more OP in one of them."
    ),
    "process_dynamics": (
        "In manual, step OP once and wait for five time constants. An integrating process goes on at a "
        "steady rate; an inverse response first moves against its end."
    ),
    "disturbance": (
        "In manual, keep OP still for at least ten periods. A wave from outside goes on; a step of the load "
        "does not come again."
    ),
    "valve_characteristic": (
        "In manual, step OP through its range in ten equal steps and wait each time. Two straight parts have a "
        "corner between two of them, a curve has none."
    ),
    "pv_gain": (
        "In manual, step OP through its range in ten equal steps and wait each time. A titration is steepest in "
        "the middle, another curve at one end."
    ),
    "extra_lag": (
        "No test with OP and PV alone: a lag before and one behind the process respond alike. Record the "
        "position of the valve, or PV by a second transmitter."
    ),
}
"""Test for each family whose members one record may not distinguish, after what they do (docs/effects)."""


def distinguishing_test(family: str | None) -> str | None:
    """Return the test that distinguishes the members of a family; None where none is known."""
    return TESTS.get(family or "")
