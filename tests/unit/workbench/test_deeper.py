"""A larger model that falls into a deeper valley of the smaller one has no credit for it."""

import pytest

from agent.analysis.record.recording import LoopWindow
from agent.workbench.first.deeper import deeper
from agent.workbench.hooks import silent
from agent.workbench.session import Workbench
from agent.workbench.session.step_tree import StepTree
from simulators.draws.open_records import open_record


@pytest.fixture(scope="module")
def bench():
    """A zero whose search ends beside its deepest valley, which is a hundredth of a sample wide."""
    record = open_record(91627, "steps", "inverse_response")
    bench = Workbench(LoopWindow("steps", 0.0, record.scenario.ts, record.op, record.pv))
    bench.add("inverse_response")
    return bench


def test_the_smaller_model_is_fitted_anew_there(bench):
    before = bench.step
    bench.tried()
    after = bench.step
    assert after.effects == before.effects
    assert after.verdict == before.verdict
    assert after.rmse_fit < 0.9 * before.rmse_fit
    assert len(bench.staircase()) == 2


def test_what_was_tried_is_then_no_better_for_it(bench):
    found = bench.tried()
    assert found.decision.effect is None
    assert deeper(bench.step, found.models.values(), bench.record, bench.folds) is None


def test_a_tree_looks_at_the_model_that_was_fitted_anew(bench):
    tree = StepTree(bench.window, "fopdt", map, silent)
    tree.add("inverse_response")
    before, found = tree.node.step, tree.compared()
    assert tree.node.step is found.steps[-1]
    assert tree.node.step.rmse_fit < 0.9 * before.rmse_fit
    tree.go(0)
    tree.add("inverse_response")
    assert tree.node.step is found.steps[-1]
    assert len(tree.nodes) == 2


def test_who_goes_the_same_way_again_gets_the_model_that_was_fitted_anew(bench):
    bench.tried()
    step = bench.step
    bench.undo()
    assert bench.add("inverse_response") is step
