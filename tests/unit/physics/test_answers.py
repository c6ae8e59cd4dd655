"""What the response does more for small moves of the valve, behind a curve of the sensor too."""

import numpy as np
import pytest

from agent.physics.bases import BASES
from agent.physics.effect import Facts
from agent.physics.effects import EFFECTS
from agent.physics.loop_model import LoopModel

OP = 50 + 10 * np.sin(2 * np.pi * np.arange(300.0) / 60)
FACTS = Facts(1.0, len(OP), 40.0, 60.0, 0.0, 1.0, 60.0, 1.0, 1)
VALUES = {
    "pv_gain": (0.06,),
    "square_law": (35.0,),
    "titration": (52.0, 3.0),
    "sensor_lag": (5.0,),
    "loss_curve": (0.05, 50.0),
}


@pytest.mark.parametrize("name", [*VALUES, ""])
def test_small_moves_are_answered_by_the_slope_where_the_response_is(name):
    base = next(each for each in BASES if each.name == "fopdt")
    effects = tuple(each for each in EFFECTS if each.name == name)
    layout = LoopModel(base, effects).layout(FACTS)
    values = np.array([3.0, 8.0, *VALUES.get(name, ())])
    moves = np.column_stack([OP > 50, np.cos(OP)]).astype(float)
    found = layout.answers(OP, moves, values)
    for answer, move in zip(found.T, moves.T, strict=True):
        there, here = (layout.response(OP + part * move, values) for part in (1e-4, -1e-4))
        expected = (there - here) / 2e-4
        np.testing.assert_allclose(answer - answer[0], expected - expected[0], atol=5e-3 * np.ptp(expected))
