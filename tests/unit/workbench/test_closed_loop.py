"""In closed loop OP holds the disturbance: an effect that answers to it is none."""

import numpy as np
import pytest

from agent.identify.noise.autoregression import innovations
from agent.workbench.innovations import likelihood_ratio

N = 2000


def loop(seed, slack):
    """PV of a first-order process under integral control, with a slow load; ``slack`` in OP units."""
    rng = np.random.default_rng(seed)
    op, pv, load, plug, integral = np.zeros(N), np.zeros(N), 0.0, 0.0, 0.0
    set_point = np.repeat(rng.uniform(-6, 6, N // 100), 100)
    for t in range(1, N):
        plug = min(max(plug, op[t - 1] - slack / 2), op[t - 1] + slack / 2)
        load = 0.97 * load + 0.15 * rng.standard_normal()
        pv[t] = 0.9 * pv[t - 1] + 0.1 * (plug + load)
        integral += 0.06 * (set_point[t] - pv[t])
        op[t] = integral + 0.8 * (set_point[t] - pv[t])
    return op, pv + 0.01 * rng.standard_normal(N)


def answered_more(op, part):
    """What PV gets beside where OP moves it by 40 % more in part of the samples, (N,)."""
    more, moves = np.zeros(N), np.where(part, 0.4 * op, 0.0)
    for t in range(1, N):
        more[t] = 0.9 * more[t - 1] + 0.1 * moves[t - 1]
    return more


def free_run(op, width):
    plug, pv = 0.0, np.zeros(N)
    for t in range(1, N):
        plug = min(max(plug, op[t - 1] - width / 2), op[t - 1] + width / 2)
        pv[t] = 0.9 * pv[t - 1] + 0.1 * plug
    return pv


def better(smaller, larger, parameters):
    """Whether the record is likelier with the larger model, its parameters paid by Schwarz."""
    ratio = likelihood_ratio(innovations(smaller), innovations(larger))
    return ratio >= parameters * np.log(N)


@pytest.mark.parametrize("seed", [0, 1, 3, 4])
def test_a_dead_band_that_hides_the_controllers_answer_is_none(seed):
    op, pv = loop(seed, slack=0.0)
    true, wrong = pv - free_run(op, 0.0), pv - free_run(op, 0.7)
    assert wrong.var() < true.var()  # the free run alone takes it for an effect
    assert not better(true, wrong, 2)


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_a_dead_band_that_is_there_is_one(seed):
    op, pv = loop(seed, slack=1.5)
    assert better(pv - free_run(op, 0.0), pv - free_run(op, 1.5), 2)
    assert not better(pv - free_run(op, 1.5), pv - free_run(op, 1.5), 1)
    assert better(pv - free_run(op, 1.5), pv - free_run(op, 1.5), 0)
