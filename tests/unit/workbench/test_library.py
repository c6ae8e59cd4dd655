from loops import moves

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.workbench.library import acts_on_op, happens_once
from agent.workbench.record import bare_record


def test_what_happens_once_is_a_disturbance_with_an_instant():
    facts = bare_record(LoopWindow("made", 0.0, 1.0, moves(), moves())).facts
    assert [each.name for each in EFFECTS if happens_once(each, facts)] == ["load_step", "gain_change"]


def test_only_disturbances_of_their_own_time_do_not_answer_to_op():
    facts = bare_record(LoopWindow("made", 0.0, 1.0, moves(), moves())).facts
    assert [each.name for each in EFFECTS if not acts_on_op(each, facts)] == ["sinusoid", "wave", "load_step"]
