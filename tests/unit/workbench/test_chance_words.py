"""What stands beside the share of a candidate: never an interval above zero with a p that denies it."""

from dataclasses import replace

import pytest

from agent.analysis.record.recording import LoopWindow
from agent.report.comparison_text import chance_words
from agent.workbench.candidates import ANSWERS
from agent.workbench.checks.wave_lines import SLOW
from agent.workbench.hypotheses import Candidate
from agent.workbench.session import Workbench
from simulators.draws.open_records import open_record

STEP = Candidate("load_step", "disturbance", 29.0, 10.0, 48.0, 0.003)


@pytest.mark.parametrize(
    ("candidate", "words"),
    [
        (STEP, "p = 0.003"),
        (replace(STEP, p=0.051), "p = 0.051"),
        (replace(STEP, p=1.0), "may be chance"),
        (replace(STEP, p=1.0, objection="it stands for another"), "rejected: it stands for another"),
        (replace(STEP, low=-3.0, p=1.0), "p = 1"),
        (replace(STEP, low=-3.0, p=1.0, objection="small anyway"), "p = 1"),
    ],
)
def test_a_share_and_its_p_are_of_the_same_thing(candidate, words):
    assert chance_words(candidate) == words


def test_in_manual_no_effect_is_said_to_repeat_a_controller():
    record = open_record(91580, "steps", "stiction")
    found = Workbench(LoopWindow("steps", 0.0, record.scenario.ts, record.op, record.pv)).comparison()
    rejected = {each.effect: each.objection for each in found.candidates}
    assert rejected["inverse_response"] == SLOW
    assert ANSWERS not in rejected.values()
