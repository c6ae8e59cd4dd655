"""The linear base of order three against its equation, integrated in small steps, and its first values."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lsim

from agent.physics.bases.between_samples import first_values, values_of
from agent.physics.bases.third_order import ThirdOrder, ThirdOrderProcess

OP = np.repeat(np.random.default_rng(3).uniform(40, 60, 20), 40)
FINE = 50
CASES = [
    # late, tau, damping, zero, curve, lag
    (0, 5.0, 0.2, 1.0, 0.5, 3.0),
    (20, 5.0, 0.2, -1.0, -2.0, 3.0),
    (90, 4.0, 1.2, 2.0, 0.1, 10.0),
    (50, 6.0, 0.01, 0.5, 1.5, 0.5),
]


def exact(late: int, tau: float, damping: float, zero: float, curve: float, lag: float) -> np.ndarray:
    """PV for gain one, delayed by some fine steps beside the sample that OP is held."""
    held = np.repeat(OP, FINE)
    bottom = np.convolve([tau**2, 2 * damping * tau, 1.0], [lag, 1.0])
    system = (np.trim_zeros([curve * tau**2, zero * tau, 1.0], "f"), bottom)
    _, response, _ = lsim(system, held - held[0], np.arange(len(held)) / FINE, interp=False)
    return np.concatenate((np.zeros(late), response))[: len(held) : FINE]


@pytest.mark.parametrize("case", CASES)
def test_it_is_exact_for_a_held_op_at_any_dead_time(case) -> None:
    late, tau, damping, zero, curve, lag = case
    process = ThirdOrderProcess(
        delay=1 + late / FINE, tau=tau, damping=damping, zero=zero, curve=curve, behind=lag
    )
    assert process.respond(OP, 1.0) - OP[0] == pytest.approx(exact(*case), abs=1e-6 * np.ptp(OP))


def test_a_lag_that_is_one_of_the_others_has_an_answer() -> None:
    at, near = (
        ThirdOrderProcess(delay=1.0, tau=4.0, damping=1.0, behind=lag).respond(OP, 1.0)
        for lag in (4.0, 4.004)
    )
    assert at == pytest.approx(near, abs=1e-2 * np.ptp(OP))


def test_first_values_are_the_process_where_there_is_no_noise() -> None:
    case = CASES[0]
    found = first_values(OP, 20 + 2 * exact(*case), 3, ts=1.0)[0]
    assert found == pytest.approx([1.0, *case[1:]], rel=1e-4)


def test_first_values_do_not_need_a_record_that_begins_at_rest() -> None:
    case = (0, 5.0, 0.2, 0.0, 0.0, 3.0)
    moving = slice(100, None)
    found = first_values(OP[moving], 20 + 2 * exact(*case)[moving], 3, ts=1.0)[0]
    assert found[[0, 1, 2, 5]] == pytest.approx([1.0, 5.0, 0.2, 3.0], rel=1e-3)


def test_a_pole_that_no_held_process_has_is_a_fast_one() -> None:
    found = values_of((np.array([0.2, 0.0, 0.0]), np.poly([0.9, 0.5, -0.3]), 0), ts=1.0)
    assert np.isfinite(found).all()
    assert np.all(found[[1, 5]] > 0.0)


def test_it_settles_when_the_slowest_of_it_has() -> None:
    delay, tau, damping, zero, curve, lag = 1.0, 4.0, 0.1, 0.0, 0.0, 10.0
    process = ThirdOrder().process(np.array((delay, tau, damping, zero, curve, lag)))
    assert process.settling == pytest.approx(150.0)
