import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from loops import made

from agent.physics.bases import Fopdt
from agent.physics.effects.deadband import Deadband
from agent.physics.loop_model import LoopModel
from agent.workbench.record import bare_record
from agent.workbench.space import space_of

FACTS = bare_record(made()).facts
SPACE = space_of(LoopModel(Fopdt(), (Deadband(),)), FACTS)


@given(st.lists(st.floats(0, 1), min_size=len(SPACE), max_size=len(SPACE)))
def test_there_and_back(at):
    assert SPACE.at(SPACE.values(np.array(at))) == pytest.approx(np.array(at), abs=1e-9)


@given(st.lists(st.floats(-0.5, 1.5), min_size=2 * len(SPACE), max_size=2 * len(SPACE)))
def test_values_are_those_of_numpy_within_the_cube(at):
    points = np.array(at).reshape(2, -1)
    inner = SPACE.low + np.clip(points, 0.0, 1.0) * (SPACE.high - SPACE.low)
    expected = np.where(SPACE.log, np.exp(inner), inner)
    assert SPACE.values(points) == pytest.approx(expected, rel=1e-12)
    assert SPACE.values(points[1]).tolist() == SPACE.values(points)[1].tolist()


def test_a_logarithm_is_halfway_at_the_geometric_mean():
    tau = SPACE.names.index("tau")
    parameter = SPACE.parameters[tau]
    middle = SPACE.values(np.full(len(SPACE), 0.5))[tau]
    assert middle == pytest.approx(np.sqrt(parameter.low * parameter.high))


def test_bounds_are_reported_but_not_of_where_a_record_begins():
    low = SPACE.values(np.zeros(len(SPACE)))
    assert SPACE.at_bound(low) == ("delay", "tau")  # a band of 0 is no band: nothing ran anywhere
    high = SPACE.values(np.ones(len(SPACE)))
    assert SPACE.at_bound(high) == ("delay", "tau", "deadband.s")
    assert SPACE.at_bound(SPACE.values(np.full(len(SPACE), 0.5))) == ()
