"""Three loops of the hidden-effect benchmark, seeds that nothing was set on: its short form."""

import pytest

from benchmarks.decoy import Decoy
from benchmarks.hidden_case import judge

pytestmark = [pytest.mark.bench, pytest.mark.timeout(300)]  # a loaded machine takes its time


@pytest.mark.parametrize(("truth", "seed"), [("none", 200), ("sinusoid", 200)])
def test_what_is_hidden_is_named_and_nothing_else(truth, seed):
    case = judge(truth, seed, ask_without=False)
    assert not case.wrong
    assert not case.decoys
    assert case.family_right == (truth != "none")
    assert case.rmse_last < 1.15 * case.floor
    assert case.floor_low < case.floor < case.floor_high


def test_decoys_differ():
    assert Decoy(1).name != Decoy(2).name
    assert Decoy(1).family == "decoy"
