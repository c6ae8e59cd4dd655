"""Recordings of one valve, judged together.

Each is diagnosed alone; what is undecided alone is judged again with the evidence of all, and P(sticks) of
the valve does not contradict that. A firm verdict stays, because a valve may be repaired or wear between two
recordings; ``others`` states a contradiction.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.analysis.diagnose import verdict_of, with_verdict
from agent.analysis.diagnosis import OtherRecordings
from agent.analysis.evidence.together import weigh_together
from agent.analysis.evidence.weighing import SURE
from agent.analysis.memory.sticks import in_view_of, sticks_of
from agent.analysis.memory.weighing_windows import BASE_RATE
from agent.analysis.record.same_event import one_of_each

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.evidence.weighing import Weighed
    from agent.analysis.record.recording import LoopWindow


def judged_together(
    windows: Sequence[LoopWindow], diagnoses: Sequence[Diagnosis], base_rate: float = BASE_RATE
) -> tuple[Diagnosis, ...]:
    """Return the diagnoses of recordings of one valve, each in view of the others.

    Only those are weighed that ``free_run`` has an answer for; any other keeps its verdict, and so do all
    where there is but one event.

    Args:
        windows: The recordings.
        diagnoses: Of each, alone.
        base_rate: Part of the valves of the plant that stick.
    """
    usable = [k for k, each in enumerate(diagnoses) if _has_evidence(each)]
    stands = [usable[k] for k in one_of_each([windows[k] for k in usable])]
    events = sorted(set(stands))
    stem = all(windows[k].mv is not None for k in events)
    together = weigh_together([diagnoses[k] for k in events], stem_measured=stem) if len(events) > 1 else None
    testable = [k for k, each in enumerate(diagnoses) if k not in usable or k in events]
    sticks = sticks_of([diagnoses[k] for k in testable], base_rate)
    if together is not None:
        sticks = in_view_of(sticks, together)
    revised = [replace(each, sticks=sticks) for each in diagnoses]
    for k, place in zip(usable, stands, strict=True):
        if together is not None:
            revised[k] = _revised(revised[k], windows[k], together, others=len(events) - 1)
        if place != k:
            revised[k] = replace(revised[k], same_event_as=windows[place].loop)
    return tuple(revised)


def _has_evidence(diagnosis: Diagnosis) -> bool:
    """Return whether ``free_run`` has an answer that can be weighed."""
    found = diagnosis.quantification
    return found is not None and found.failure is None and found.quick_evidence is not None


def _revised(diagnosis: Diagnosis, window: LoopWindow, together: Weighed, *, others: int) -> Diagnosis:
    """Return the diagnosis in view of ``others`` recordings."""
    found, alone = diagnosis.quantification, diagnosis.weighed
    if found is None or alone is None:
        return diagnosis
    if diagnosis.verdict != "undecided":
        contrary = _contrary(diagnosis, together)
        view = OtherRecordings(others, together.probability, alone=None, contrary=contrary)
        return replace(diagnosis, others=view)
    revised = with_verdict(diagnosis, window, *verdict_of(found, together))
    view = OtherRecordings(others, together.probability, alone=alone.probability, contrary=False)
    return replace(revised, others=view)


def _contrary(diagnosis: Diagnosis, together: Weighed) -> bool:
    """Whether all together would be sure of the contrary."""
    if diagnosis.verdict == "stiction":
        return together.probability <= 1 - SURE
    return together.probability >= SURE
