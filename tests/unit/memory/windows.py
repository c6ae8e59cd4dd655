"""Diagnoses of windows with given numbers, for tests of the memory."""

from dataclasses import replace

from agent.analysis.evidence.weighing import Weighed
from agent.analysis.memory.valve_memory import DAY
from agent.analysis.results import IntervalEstimate, ProcessEstimate, ProcessIntervals
from tests.unit.analysis.diagnoses import STICKING, WINDOW, judged

START = 1.7e9 - 1.7e9 % DAY
HOUR = 3600.0
ALONE = judged(WINDOW, STICKING)


def said(probability, s=None, gain=None, verdict="undecided"):
    """A diagnosis whose window alone gives ``probability``."""
    found = ALONE.quantification
    stiction = found.stiction
    if s is not None:
        stiction = replace(stiction, s=IntervalEstimate(s, 0.9 * s, 1.1 * s))
    process = None
    if gain is not None:
        ends = ProcessIntervals((0.9 * gain, 1.1 * gain), (4.0, 6.0), (1.0, 3.0))
        process = ProcessEstimate("fopdt", gain, 5.0, 2.0, intervals=ends)
    found = replace(found, stiction=stiction, process=process)
    return replace(
        ALONE, verdict=verdict, quantification=found, weighed=Weighed(probability, ()), no_response=None
    )
