"""How much of a simulated valve's position the damped stem leaves unexplained with the true friction."""

import numpy as np
import pytest

from agent.physics.valves.damped_stem import damped_stem
from agent.physics.valves.he2007 import he2007
from agent.physics.valves.two_state import two_state
from simulators.plant import simulate
from simulators.random_plants import random_plant

STEMS = {  # seed: damping and supply, samples, and rest; found by a random search
    3: (0.339, 0.169, 0.011),
    10: (0.196, 0.134, 0.005),
    27: (0.324, 0.269, 0.001),
    34: (0.336, 0.058, 0.008),
    36: (0.597, 0.28, 0.014),
}
UNEXPLAINED = 0.001
"""Share of the variance of the position."""


@pytest.mark.parametrize("seed", STEMS)
def test_only_the_damped_stem_moves_as_karnopps(seed):
    loop = random_plant(seed, "stiction")
    assert loop.valve.law == "karnopp"
    record = simulate(loop)
    start = np.flatnonzero(np.diff(record.mv[6:]) == 0)[0] + 6  # the stem rests there
    op = record.op[start:-1]
    moved = record.mv[start + 1 :]  # at the end of the sample in which OP is held
    bands = loop.valve.f_s, loop.valve.f_d

    def unexplained(position):
        return np.mean((position - moved) ** 2) / np.var(moved)

    assert unexplained(damped_stem(op, *bands, record.mv[start], *STEMS[seed])) < UNEXPLAINED
    for limit in (he2007, two_state):
        assert unexplained(limit(op, *bands, record.mv[start])) > 10 * UNEXPLAINED
