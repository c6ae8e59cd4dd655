"""The filter of slips against all histories of a short record."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter
from slip_filter_by_hand import all_histories, answers, student

from agent.analysis.innovations.slip_filter import (
    HISTORIES,
    Friction,
    ObservedPv,
    least_kept,
    likeliest_history,
)
from agent.identify.objective import Process
from agent.physics.valves.damped_stem import stem_motion

F_S, F_D, SCATTER = 2.0, 1.0, 0.3
GAIN, SQUARES, POWER = 1.5, 0.04, 2.5
PROCESS = Process(pole=0.6, pole2=0.3, keep=0.9, block=1, whole=1, now=0.2, then=0.08)
RESTS = np.array([-0.5, 0.4])
LAGS = np.array([0.5, -0.2])


def histories_of(op, *, slides):
    return list(all_histories(op, F_S, F_D, SCATTER, RESTS, slides=slides))


def seen_of(op, *, slides, noise, lags=LAGS):
    """PV behind one of the histories, with noise."""
    found = histories_of(op, slides=slides)
    _, rest, positions, _ = max(found, key=lambda each: each[0] * np.ptp(each[2]))
    answered = answers(rest, positions, PROCESS)[: len(op) - PROCESS.whole]
    pv = GAIN * np.concatenate([np.zeros(PROCESS.whole), answered])
    target = lfilter([1, *-lags], [1], pv) + noise * np.random.default_rng(3).normal(size=len(op))
    return found, ObservedPv(op, target, np.ones(len(op)), SQUARES, POWER, GAIN, lags)


def filtered(seen, *, slides):
    motion = stem_motion(0.01, 0.01, 0.0 if slides else 1e-8)
    return likeliest_history(seen, PROCESS, Friction(F_S, F_D, SCATTER), motion, RESTS)


@pytest.mark.parametrize("lags", [LAGS, np.zeros(0)])
@pytest.mark.parametrize("slides", [False, True])
@pytest.mark.parametrize("op", [[0.0, 1.0, 1.8, 0.0], [0.0, 1.5, 3.5, 3.6, 2.0]])
def test_with_all_histories_kept_it_is_their_sum(op, slides, lags):
    op = np.array(op)
    found, seen = seen_of(op, slides=slides, noise=0.02, lags=lags)
    assert 2 < len(found) <= HISTORIES
    assert sum(probability for probability, *_ in found) == pytest.approx(1, abs=1e-5)
    together = [
        probability * student(rest, positions, seen, PROCESS) for probability, rest, positions, _ in found
    ]
    path, factors, likely = filtered(seen, slides=slides)
    assert likely == pytest.approx(math.log(sum(together)), abs=1e-4)
    _, _, positions, begun = found[int(np.argmax(together))]
    assert path == pytest.approx(positions, abs=1e-5)
    assert factors == pytest.approx(begun, abs=1e-5)


def test_with_some_drawn_for_all_it_stays_near_their_sum():
    """Thirteen samples have some hundred histories, of which no more than 24 are followed."""
    op = np.array([0.0, 1.2, 1.7, 2.0, 2.3, 2.6, 2.9, 3.1, 3.4, 3.7, 4.0, 4.4, 4.8])
    found, seen = seen_of(op, slides=False, noise=0.05)
    assert len(found) > 3 * HISTORIES
    together = sum(
        probability * student(rest, positions, seen, PROCESS) for probability, rest, positions, _ in found
    )
    _, _, likely = filtered(seen, slides=False)
    assert likely == pytest.approx(math.log(together), abs=0.1)


def test_the_weight_that_is_kept_leaves_as_many_as_are_followed():
    weights = np.random.default_rng(1).exponential(size=70) ** 3
    weights /= weights.sum()
    assert np.minimum(weights / least_kept(weights), 1).sum() == pytest.approx(HISTORIES)
    assert least_kept(weights[:HISTORIES]) < 1e-200


def test_a_sample_that_no_history_explains_ends_none():
    op = np.array([0.0, 1.0, 1.8, 1.0])
    _, seen = seen_of(op, slides=False, noise=0.02)
    target = seen.target.copy()
    target[2] = 1e200
    path, _, likely = filtered(seen._replace(target=target), slides=False)
    assert np.isfinite(path).all()
    assert math.isfinite(likely)
