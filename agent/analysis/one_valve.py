"""Recordings of one valve, judged together.

Each says what it says alone; what is undecided alone is looked at again with what all say. A firm verdict
stays, for a valve may be repaired or wear between two recordings; that the others say otherwise is told.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.analysis.diagnose import SURE, verdict_of, with_verdict
from agent.analysis.evidence.together import weigh_together
from agent.analysis.evidence.weighing import weigh
from agent.analysis.record.same_event import one_of_each

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.evidence.weighing import Weighed
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import Diagnosis

CONTRARY = "it keeps its own verdict, for a valve may be repaired, or wear, between two recordings"


def judged_together(windows: Sequence[LoopWindow], diagnoses: Sequence[Diagnosis]) -> tuple[Diagnosis, ...]:
    """Return the diagnoses of recordings of one valve, each with what the others tell of it.

    Only those are weighed that ``free_run`` has an answer for; any other keeps its verdict, and so do all
    where there is but one event.

    Args:
        windows: The recordings.
        diagnoses: Of each, alone.
    """
    asked = [k for k, each in enumerate(diagnoses) if _speaks(each)]
    stands = [asked[k] for k in one_of_each([windows[k] for k in asked])]
    events = sorted(set(stands))
    stem = all(windows[k].mv is not None for k in events)
    together = weigh_together([diagnoses[k] for k in events], stem_measured=stem) if len(events) > 1 else None
    told = list(diagnoses)
    for k, place in zip(asked, stands, strict=True):
        if together is not None:
            told[k] = _revised(diagnoses[k], windows[k], together, others=len(events) - 1)
        if place != k:
            words = f"it shows the same event as {windows[place].loop}: the two count once"
            told[k] = replace(told[k], reasons=(*told[k].reasons, words))
    return tuple(told)


def _speaks(diagnosis: Diagnosis) -> bool:
    found = diagnosis.quantification
    return found is not None and found.failure is None and found.quick_evidence is not None


def _revised(diagnosis: Diagnosis, window: LoopWindow, together: Weighed, *, others: int) -> Diagnosis:
    """Return the diagnosis in view of ``others`` recordings, the reason for it first."""
    found = diagnosis.quantification
    if found is None:
        return diagnosis
    count = "the other recording" if others == 1 else f"the {others} other recordings"
    joint = f"with {count} of this valve the odds that it sticks are {odds(together.probability)}"
    if diagnosis.verdict != "undecided":
        against = _against(diagnosis, together)
        words = f"{joint}; {CONTRARY}" if against else joint
        return replace(diagnosis, reasons=(words, *diagnosis.reasons))
    alone = weigh(found, diagnosis.methods, stem_measured=window.mv is not None).probability
    verdict, confidence = verdict_of(found, together)
    revised = with_verdict(diagnosis, window, verdict, confidence)
    words = f"alone this recording is undecided (odds {odds(alone)}); {joint}"
    return replace(revised, reasons=(words, *revised.reasons))


def _against(diagnosis: Diagnosis, together: Weighed) -> bool:
    """Whether all together would be sure of the contrary."""
    if diagnosis.verdict == "stiction":
        return together.probability <= 1 - SURE
    return together.probability >= SURE


def odds(probability: float) -> str:
    """Say a probability as odds, ``4.2 to 1`` or ``1 to 4.2``."""
    more = probability / (1 - probability)
    return f"{more:.2g} to 1" if more >= 1 else f"1 to {1 / more:.2g}"
