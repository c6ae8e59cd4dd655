"""Isolated wild samples of a running loop: gaps, counted, and no limit of OP, in whatever window they lie."""

import math

import numpy as np
import pytest

from agent.analysis.gates import gates
from agent.analysis.oscillation import detect_oscillation
from agent.runtime.intake.window import RollingWindow
from tests.unit.runtime.loops import loop_settings, pushed, sample

N = 600
NOISE = np.random.default_rng(5).normal(0, 0.1, (N, 2))


def windows_of(wild):
    """The windows of a loop in which some samples, (role, time) -> value, are wild."""
    window = RollingWindow(loop_settings(seconds=300.0, hop=0.25))
    released = []
    for t in range(N):
        for k, role in enumerate(("pv", "op")):
            value = 50 + 5 * math.sin(t / 8 + k) + NOISE[t, k]
            found = pushed(window, sample(role, t, wild.get((role, t), value)), t + 0.1 * k)
            released += [] if found is None else [found]
    return released


@pytest.mark.parametrize("value", [-999.0, 65535.0, 1e6, 0.0 - 1e5])
@pytest.mark.parametrize("role", ["pv", "op"])
def test_they_are_gaps_and_nothing_stands_at_a_limit(role, value):
    places = (150, 310, 311, 402)
    windows = windows_of({(role, t): value for t in places})
    assert len(windows) == 5
    for each in windows:
        inside = [t for t in places if each.time[0] <= 1.7e9 + t <= each.time[-1]]
        assert each.wild == len(inside)
        signal = each.pv if role == "pv" else each.op
        assert np.nanmax(np.abs(signal - 50)) < 6
        assert np.count_nonzero(np.isnan(signal)) == len(inside)
        assert "op_saturated" not in {fault.name for fault in gates(each, detect_oscillation(each))}


def test_the_newest_and_the_oldest_sample_of_a_window_may_be_wild():
    windows = windows_of({("op", 299): 65535.0, ("op", 374): 1e6, ("pv", 75): -999.0})
    assert [each.wild for each in windows[:2]] == [2, 3]
