"""What the innovations say for and against an effect, and which of two rivals they drop."""

import numpy as np
import pytest
from test_closed_loop import N, answered_more, loop

from agent.analysis.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects.deadband import Deadband
from agent.physics.effects.gain_change import GainChange
from agent.physics.effects.load_step import LoadStep
from agent.physics.loop_model import LoopModel
from agent.workbench.evidence import VERY_STRONG, Evidence, evidence_of, less_likely
from agent.workbench.fit import fit, nested_fit
from agent.workbench.record import bare_record

CANDIDATES = 14


@pytest.fixture(scope="module")
def changed():
    """A loop of which OP moves PV by 40 % more from sample 1000 on."""
    op, pv = loop(1, slack=0.0)
    more = answered_more(op, np.arange(N) > 1000)
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv + more))
    return fit(LoopModel(Fopdt()), record, record.weight), record


def evidence(effect, base, record):
    return evidence_of(base, nested_fit(base, LoopModel(Fopdt(), (effect,)), record), record, CANDIDATES)


def test_it_is_for_what_changed_and_not_for_what_stands_in_for_it(changed):
    found = {each.name: evidence(each, *changed) for each in (GainChange(), LoadStep(), Deadband())}
    assert found["gain_change"].more
    assert found["gain_change"].by_chance < 1e-10
    assert not found["deadband"].more
    assert "gain_change" not in less_likely(found)
    assert "load_step" in less_likely(found)


def test_a_step_of_a_loop_without_one_is_chance():
    op, pv = loop(2, slack=0.0)
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv))
    base = fit(LoopModel(Fopdt()), record, record.weight)
    assert evidence(LoadStep(), base, record).by_chance > 0.05


def test_the_likelier_of_two_stays_and_equals_stay_both():
    often, seldom = Evidence(True, 0.0, 50.0), Evidence(True, 0.0, 49.0 - VERY_STRONG)
    assert less_likely({"a": often, "b": seldom}) == ["b"]
    assert less_likely({"a": often, "b": often}) == []
