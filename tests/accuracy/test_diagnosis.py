"""The diagnosis on simulated loops, seeds that nothing was set on: a short form of `benchmarks diagnosis`."""

import pytest

from benchmarks.cases.diagnosed_loop import diagnosed_loop
from benchmarks.cases.random_loop import MOVED, STEADY

SEEDS = (5000,)


@pytest.fixture(scope="module")
def steady():
    return [diagnosed_loop((kind, seed)) for kind in STEADY for seed in SEEDS]


@pytest.fixture(scope="module")
def moved():
    return [diagnosed_loop((kind, seed)) for kind in MOVED for seed in SEEDS]


def test_cause_is_named_where_the_loop_runs_by_itself(steady):
    assert sum(each.right for each in steady) >= len(steady) - 1


def test_no_sound_valve_is_accused_and_no_limit_cycle_cleared(steady):
    assert not [each for each in steady if each.verdict == "stiction" and not each.sticks]
    assert not [each for each in steady if each.verdict == "no_stiction" and each.sticks]


@pytest.mark.bench
def test_no_sound_valve_is_accused_where_the_set_point_moves(moved):
    assert not [each for each in moved if each.verdict == "stiction" and not each.sticks]


@pytest.mark.bench
def test_measured_stem_finds_what_pv_hides(moved):
    sticking = [each for each in moved if each.sticks]
    assert sum(each.with_stem == "stiction" for each in sticking) >= len(sticking) - 1
