"""The compiled friction laws and the lag against their twins."""

import numpy as np
import pytest
from friction_twins import karnopp, lag, lugre
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from simulators import process
from simulators.friction import Actuator, StemParameters, stroke

HOLD = 1.2  # s, long enough for a stroke to end
FINE = 2e-4  # s, step of Karnopp's twin
FINEST = 4e-5  # s, step of LuGre's twin, whose bristles are fast


@st.composite
def stems(draw):
    f_s = draw(st.floats(1.0, 8.0))
    return StemParameters(
        f_s=f_s,
        f_d=f_s * (kinetic := draw(st.floats(0.3, 1.0))),
        f_s_closing=(closing := draw(st.floats(1.0, 8.0))),
        f_d_closing=closing * kinetic,
        inertia=2e-3,  # heavy enough that the inertia matters and explicit Euler is stable
        damping=draw(st.floats(0.1, 0.3)),
        stribeck=draw(st.floats(0.05, 2.0)),
        still=1e-3,
        bristle_stiffness=100.0,
        bristle_damping=0.1,
    )


def compiled(stem, start, p, *, lugre_law, dt=1e-4):
    state = np.array([p, *start])
    stroke(state, p, round(HOLD / dt), dt, Actuator(stem, lugre_law, 0.0, np.inf, -1e9, 1e9))
    return state[1:]


@settings(max_examples=40, deadline=None)
@given(stems(), st.floats(-10, 10))
def test_karnopp_kernel_stops_where_its_twin_does(stem, op):
    f_s = stem.f_s if op > 0 else stem.f_s_closing
    assume(abs(abs(op) - f_s) > 0.02)  # at the very edge rounding decides
    x, v, _ = compiled(stem, (0.0, 0.0, 0.0), op, lugre_law=False)
    twin_x, twin_v = karnopp(0.0, 0.0, op, HOLD, FINE, stem)
    assert x == pytest.approx(twin_x, abs=0.03)
    assert v == pytest.approx(twin_v, abs=0.03)
    assert (x == 0.0) == (abs(op) < f_s)


@settings(max_examples=20, deadline=None)
@given(stems(), st.floats(-10, 10))
def test_lugre_kernel_stops_where_its_twin_does(stem, op):
    f_s = stem.f_s if op > 0 else stem.f_s_closing
    assume(abs(abs(op) - f_s) > 0.05 * f_s)
    x, v, z = compiled(stem, (0.0, 0.0, 0.0), op, lugre_law=True)
    twin_x, twin_v, twin_z = lugre(0.0, 0.0, 0.0, op, HOLD, FINEST, stem)
    assert x == pytest.approx(twin_x, abs=0.03)
    assert v == pytest.approx(twin_v, abs=0.03)
    assert z == pytest.approx(twin_z, abs=0.03 / stem.bristle_stiffness + 0.02 * abs(twin_z))


@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=30), st.floats(-1e3, 1e3), st.floats(0.0, 0.999))
def test_lag_is_the_sum_over_its_past(inputs, level, keep):
    outputs = process.lag(np.array(inputs), level, keep)
    assert outputs == pytest.approx(lag(inputs, level, keep), abs=1e-9)
