"""Strokes on a triangle of amplitude 10 and period 500, S = 7, J = 3: vector 2 of reference methods.md 9."""

import numpy as np
import pytest

from agent.physics.valves import law
from agent.physics.valves.he2007 import he2007
from agent.physics.valves.stenman2003 import stenman2003
from agent.units import FrictionBands

TRIANGLE = 10 * (2 / np.pi) * np.arcsin(np.sin(2 * np.pi * np.arange(3000) / 500))


def stroked(name):
    return law(name).position(TRIANGLE, FrictionBands.from_s_j(7.0, 3.0), 0.0)[500:]


@pytest.mark.parametrize(
    ("name", "end"),
    [
        ("kano2004", 8.0),
        ("choudhury2005", 8.0),
        ("two_state", 8.0),
        ("he2007", 6.08),
    ],
)
def test_the_stroke_is_the_published_one(name, end):
    position = stroked(name)
    assert (position.min(), position.max()) == (pytest.approx(-end), pytest.approx(end))


@pytest.mark.parametrize("name", ["kano2004", "choudhury2005"])
def test_the_sliding_laws_agree(name):
    np.testing.assert_allclose(stroked(name), stroked("two_state"), rtol=0, atol=1e-12)


def test_in_a_cycle_of_one_slip_each_way_stenmans_d_is_s():
    op = 0.6 * TRIANGLE
    he, stenman = he2007(op, 5.0, 2.0, -1.5), stenman2003(op, 7.0, -3.5)
    np.testing.assert_array_equal(np.flatnonzero(np.diff(he)), np.flatnonzero(np.diff(stenman)))
    assert np.ptp(stenman) - np.ptp(he) == pytest.approx(2 * 2.0)


def test_hes_valve_moves_far_less_often():
    assert np.count_nonzero(np.diff(stroked("he2007"))) < 60
    assert np.count_nonzero(np.diff(stroked("kano2004"))) > 1500
