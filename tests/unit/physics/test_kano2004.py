"""Kano's valve, with friction that differs between rising and falling."""

import numpy as np
import pytest

from agent.physics.valves.kano2004 import kano2004

UP = (7.0, 3.0)  # S and J: f_S 5, f_D 2
DOWN = (3.0, 1.0)  # f_S 2, f_D 1


def move(*op, x0=0.0):
    return kano2004(np.array(op, dtype=float), *UP, *DOWN, x0).tolist()


def test_each_direction_breaks_away_at_its_own_static_friction():
    assert move(4.9, 5.1) == [0, pytest.approx(3.1)]
    assert move(-1.9, -2.1) == [0, pytest.approx(-1.1)]


def test_it_slides_at_the_kinetic_friction_of_its_direction():
    assert move(6, 7, 8) == [4, 5, 6]
    assert move(-3, -4, -5) == [-2, -3, -4]


def test_a_reversal_takes_what_held_it_and_what_holds_it_now():
    assert move(10, 10 - 3.9) == [8, 8]
    assert move(10, 10 - 4.1) == [8, pytest.approx(6.9)]
    assert move(-10, -10 + 5.9) == [-9, -9]
    assert move(-10, -10 + 6.1) == [-9, pytest.approx(-5.9)]


@pytest.mark.parametrize("x0", [-4.9, 1.9])
def test_a_stem_that_rests_at_the_start_stays(x0):
    assert move(0, 0, 0, x0=x0) == [x0] * 3


def test_after_a_slip_it_slides_on_without_another_stick():
    assert move(5.1, 5.2, 5.3) == pytest.approx([3.1, 3.2, 3.3])
