"""Recordings of one simulated valve: a short form of `benchmarks one_valve`."""

import pytest

from benchmarks.one_valve import diagnosed_group


@pytest.mark.bench
def test_four_recordings_say_what_none_says_alone():
    group = diagnosed_group(("cascade_stiction", 9000))
    assert sum(each.verdict == "stiction" for each in group.alone) <= 1
    assert all(each.verdict == "stiction" for each in group.together)


@pytest.mark.bench
@pytest.mark.parametrize("kind", ["drift", "set_point"])
def test_a_load_against_op_in_all_recordings_accuses_nobody(kind):
    group = diagnosed_group((kind, 9000))
    assert any(each.verdict == "undecided" for each in group.alone)
    assert not any(each.verdict == "stiction" for each in group.together)
