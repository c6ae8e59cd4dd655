"""What stands beside the share of a candidate: the odds that decide on it, or of a wave its p."""

import math
from dataclasses import replace

import pytest

from agent.analysis.record.recording import LoopWindow
from agent.report.comparison_text import evidence_words
from agent.workbench.candidates import ANSWERS
from agent.workbench.checks.wave_lines import SLOW
from agent.workbench.hypotheses import Candidate
from agent.workbench.session import Workbench
from simulators.draws.open_records import open_record

STEP = Candidate("load_step", "disturbance", 29.0, 10.0, 48.0, 1.0, odds=2 * math.log(5000.0))
WAVE = replace(STEP, effect="sinusoid", p=0.003, odds=math.inf, by_blocks=True)


@pytest.mark.parametrize(
    ("candidate", "words"),
    [
        (STEP, "odds 1e4 to 1"),
        (replace(STEP, odds=2 * math.log(40.0)), "odds 40 to 1"),
        (replace(STEP, odds=1e4), "odds above 1e99 to 1"),
        (replace(STEP, odds=-1.0), "no likelier with it"),
        (replace(STEP, objection="it stands for another"), "not confirmed: it stands for another"),
        (replace(STEP, low=-3.0, objection="small anyway"), "odds 1e4 to 1"),
        (WAVE, "p = 0.003"),
        (replace(WAVE, p=1.0), "may be chance"),
        (replace(WAVE, low=-3.0, p=1.0), "p = 1"),
    ],
)
def test_beside_a_share_stands_what_decides_on_it(candidate, words):
    assert evidence_words(candidate) == words


def test_in_manual_no_effect_is_said_to_repeat_a_controller():
    record = open_record(91580, "steps", "stiction")
    found = Workbench(LoopWindow("steps", 0.0, record.scenario.ts, record.op, record.pv)).comparison()
    rejected = {each.effect: each.objection for each in found.candidates}
    assert rejected["inverse_response"] == SLOW
    assert ANSWERS not in rejected.values()
