"""A valve that was repaired, or still sticks, in windows in which nothing happens: its known S decides."""

import numpy as np
import pytest

from agent.analysis.record.known_process import KnownProcess, KnownValve
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.response.evidence_of_response import filtered
from agent.analysis.wear.as_before import as_before
from agent.physics.valves.he2007 import he2007

S = 4.0
KNOWN = LoopHints(known_valve=KnownValve(S, KnownProcess(gain=1.5, tau=8.0, delay=2.0, log_gain_sd=0.2)))


def window(s, travel, seed=0, gain=1.5, op_noise=0.05):
    """A loop whose OP wanders within ``travel``, its valve with S = ``s``, and noise on PV."""
    rng = np.random.default_rng(seed)
    op = 50 + travel * np.sin(np.arange(900) / 60) / 2 + op_noise * rng.standard_normal(900)
    stem = he2007(op, 0.65 * s, 0.35 * s, op[0])
    pv = 30 + gain * filtered(stem, 8.0, 2) + 0.2 * rng.standard_normal(900)
    return LoopWindow("FIC101", 0.0, 1.0, op, pv, hints=KNOWN)


@pytest.mark.parametrize("travel", [1.0, 2.5, 12.0])
def test_a_repaired_valve_does_not_stick_as_before(travel):
    assert all(as_before(window(0.05 * S, travel, seed)).log_ratio < -5 for seed in range(5))


def cancelled(seed=0, samples=1400, every=5):
    """A sound valve, its loop with a load that wanders, of which the historian keeps one scan in five."""
    rng = np.random.default_rng(seed)
    op, integral, pv, load, lagged = 50.0, 50.0, 30.0, 0.0, 0.0
    kept = []
    for k in range(samples * every):
        load = 0.995 * load + 0.25 * rng.standard_normal()
        lagged += (1.5 * (op - 50.0) + load - lagged) / 8.0
        pv = 30.0 + lagged + 1.5 * rng.standard_normal()
        integral += 0.02 * (30.0 - pv)
        op = integral + 0.04 * (30.0 - pv)
        if k % every == 0:
            kept.append((op, pv))
    moved, seen = np.array(kept).T
    return LoopWindow("FIC101", 0.0, float(every), moved, seen, hints=KNOWN)


def test_a_valve_that_sticks_does_so_as_before():
    assert all(as_before(window(S, 12.0, seed)).log_ratio > 5 for seed in range(5))


@pytest.mark.parametrize("travel", [1.0, 2.5])
def test_a_stem_that_stands_says_nothing(travel):
    """A controller that cancels a load keeps PV as still."""
    assert all(abs(as_before(window(S, travel, seed)).log_ratio) < 5 for seed in range(5))


def test_a_load_that_the_controller_cancels_is_no_stem_that_stands():
    """The instants between two samples, of which the controller knew, are not in the record."""
    found = [as_before(cancelled(seed)).log_ratio for seed in range(5)]
    assert max(found) < 0


def test_an_op_that_stands_decides_nothing():
    for s in (0.0, S):
        assert all(abs(as_before(window(s, 0.0, seed, op_noise=0.005)).log_ratio) < 5 for seed in range(5))


def test_a_gain_and_an_s_that_are_a_little_wrong_do_not_turn_it():
    assert as_before(window(0.05 * S, 2.5, gain=1.9)).log_ratio < -5
    assert as_before(window(1.2 * S, 12.0, gain=1.2)).log_ratio > 5
    assert all(as_before(window(share * S, 12.0)).log_ratio > 5 for share in (0.75, 0.9, 1.1))


def test_a_gain_that_is_hardly_known_is_enough():
    process = KnownProcess(gain=4.0, tau=8.0, delay=2.0, log_gain_sd=1.2)
    unsure = LoopHints(known_valve=KnownValve(S, process))
    assert as_before(window(0.05 * S, 2.5).with_hints(unsure)).log_ratio < -5
    assert as_before(window(S, 12.0).with_hints(unsure)).log_ratio > 5


def test_without_a_known_valve_nothing_is_said():
    known = LoopHints(known=KNOWN.known_valve.process)
    assert as_before(window(S, 12.0).with_hints(known)) is None


def test_records_without_numbers_say_nothing():
    lost, still = np.full(200, np.nan), np.full(200, 50.0)
    assert as_before(LoopWindow("FIC101", 0.0, 1.0, lost, lost, hints=KNOWN)) is None
    assert as_before(LoopWindow("FIC101", 0.0, 1.0, still, still, hints=KNOWN)) is None
