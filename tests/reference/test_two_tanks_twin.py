"""The compiled tanks against their twin."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from two_tanks_by_hand import levels

from agent.physics.bases.two_tanks import TwoTanks

TS = 4.0


@st.composite
def tanks(draw):
    exponents = [draw(st.floats(0.4, 1.2)) for _ in range(2)]
    # Water stays for ten samples or more, as the midpoint rule requires.
    flows = [draw(st.floats(0.005, 0.02)) * 5 ** (1 - exponent) for exponent in exponents]
    return TwoTanks(
        pump=draw(st.floats(0.01, 0.05)),
        flow_1=flows[0],
        exponent_1=exponents[0],
        flow_2=flows[1],
        exponent_2=exponents[1],
        zero=draw(st.floats(-1.0, 1.0)),
        start_1=draw(st.floats(1.0, 10.0)),
        start_2=draw(st.floats(2.0, 9.0)),
        limit_1=draw(st.floats(4.0, 20.0)),
        limit_2=draw(st.floats(5.0, 12.0)),
        share=draw(st.floats(0.0, 1.0)),
    )


@settings(max_examples=25, deadline=None)
@given(tanks(), st.lists(st.floats(-1.0, 7.0), min_size=1, max_size=40))
def test_tanks_stand_as_high_as_those_of_the_twin(both, command):
    assert both.respond(np.array(command), TS) == pytest.approx(levels(command, TS, both), abs=0.03)
