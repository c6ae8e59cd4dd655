"""Other bristles move S and J along, so that the valve slips when it did."""

import numpy as np
import pytest

from agent.identify.objective import BRISTLES, SIZE
from agent.identify.search.bristles import exchange_bristles, loosened
from agent.physics.valves.damped_stem import GIVE, damped_stem

DAMPING, SUPPLY, REST = 0.05, 0.1, 0.01
S, J = 0.5, 0.4


def slips(op, s, j, give):
    """Return the samples in which the stem leaves its place."""
    x = damped_stem(op, (s + j) / 2, (s - j) / 2, op[0], DAMPING, SUPPLY, REST, give)
    moves = np.abs(np.diff(x)) > 1e-9
    return np.flatnonzero(moves[1:] & ~moves[:-1])


def triangle(speed):
    way = np.arange(0.0, 1.0, speed)
    return np.concatenate((way, way[::-1], way, way[::-1]))


@pytest.mark.parametrize("speed", [0.004, 0.01, 0.03])
@pytest.mark.parametrize("give", [0.05, 0.15, 0.3])
def test_a_valve_with_other_bristles_slips_when_it_did(speed, give):
    op, candidate, bands = triangle(speed), np.zeros(SIZE), np.array([S, J])
    exchange_bristles(candidate, bands, give, speed)
    assert candidate[BRISTLES] == give
    stiff, soft = slips(op, S, J, 0.0), slips(op, *bands, give)
    assert soft == pytest.approx(stiff, abs=1)


def test_without_other_s_and_j_it_slips_sooner():
    op = triangle(0.004)
    assert slips(op, S, J, 0.3)[0] < slips(op, S, J, 0.0)[0] - 3


@pytest.mark.parametrize("give", [0.0, *GIVE])
def test_bristles_loosen_no_more_than_the_jump(give):
    found = [loosened(J, give, step) for step in (1e-4, 0.01, 1.0)]
    assert all(0.0 <= each <= J for each in found)
    assert found == sorted(found)


def test_an_exchange_and_back_leaves_the_valve_as_it_was():
    candidate, bands = np.zeros(SIZE), np.array([S, J])
    exchange_bristles(candidate, bands, 0.15, 0.02)
    assert bands[0] - S == pytest.approx(bands[1] - J)
    assert bands[0] > S
    exchange_bristles(candidate, bands, 0.0, 0.02)
    assert bands == pytest.approx([S, J], abs=0.005)
