"""Many points of a model at once against its stages one after the other, for one point at a time."""

from __future__ import annotations

from functools import reduce

import numpy as np
import pytest

from agent.checks.effect_record import FACTS, OP
from agent.physics.bases import BASES
from agent.physics.effects import EFFECTS
from agent.physics.effects.deadband import Deadband
from agent.physics.effects.rate_limit import RateLimit
from agent.physics.effects.stiction import Stiction
from agent.physics.loop_model import LoopModel
from agent.physics.valves.kano2004 import Kano2004
from agent.workbench.library import applies
from agent.workbench.space import space_of

MODELS = [
    *(LoopModel(base) for base in BASES),
    *(LoopModel(base, (each,)) for base in BASES for each in EFFECTS if applies(each, base)),
    LoopModel(BASES[0], (Stiction(law=Kano2004()),)),
    LoopModel(BASES[0], (RateLimit(), Deadband(), Stiction())),
]


def one_after_the_other(model, values):
    """Return the columns as rows, (1 + k, n), by calls of each stage."""
    layout, ts = model.layout(FACTS), FACTS.ts
    position = reduce(lambda moved, each: each.effect.apply(moved, values[each.own], ts), layout.valve, OP)
    response = layout.response(position, values)
    time = ts * np.arange(len(OP))
    added = (each.effect.columns(time, response, values[each.own]) for each in layout.disturbances)
    return np.vstack((response, *(columns.T for columns in added)))


@pytest.mark.parametrize(
    "model", MODELS, ids=lambda model: "-".join((model.base.name, *(each.name for each in model.effects)))
)
def test_many_points_are_those_of_single_ones(model):
    space = space_of(model, FACTS)
    points = np.random.default_rng(0).random((4, len(space)))
    points[1] = 0.0
    values = space.values(points)
    found = model.layout(FACTS).rows(OP, values)
    for each, own in zip(found, values, strict=True):
        expected = one_after_the_other(model, own)
        np.testing.assert_allclose(each, expected, rtol=0, atol=1e-12 * max(np.abs(expected).max(), 1.0))
