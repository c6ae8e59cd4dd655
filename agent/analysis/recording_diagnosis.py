"""A recording of any length to a diagnosis: a long one is weighed by its stretches, as by windows of a valve.

Log likelihoods of stretches are not added, as those of a few recordings are: what a model lacks is in each of
them, so that many stretches that show little would be as sure as one that shows much.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.diagnose import diagnose, verdict_of, with_verdict
from agent.analysis.diagnosis import Stretches
from agent.analysis.evidence.weighing import Weighed
from agent.analysis.memory.sticks import sticks_of
from agent.analysis.recording_stretches import part_of, stretches_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.diagnosis import Diagnosis, RecordSummary
    from agent.analysis.quantify import Quantifier
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import IntervalEstimate

EVEN = 0.5
"""Base rate of the confidence of a recording. Where it is 0.8, so that stiction is reported, P(sticks) at the
usual rate, a valve in five, is 0.5."""
LEAST_WIDTH = 1e-6
"""Of an interval of S, spans of OP: its information is finite."""


def diagnose_recording(
    window: LoopWindow, *, quantifier: Quantifier | None = None
) -> tuple[Diagnosis, LoopWindow]:
    """Return the diagnosis of a recording, and the part of it whose numbers it has.

    A recording no longer than a window of the agent is that part. A longer one is weighed by its stretches;
    numbers and pictures are those of one of them.

    Args:
        window: The whole recording.
        quantifier: The method that measures stiction; None takes the default one.
    """
    places = stretches_of(window)
    if len(places) == 1:
        return diagnose(window, quantifier=quantifier), window
    parts = [part_of(window, each) for each in places]
    alone = [diagnose(each, quantifier=quantifier) for each in parts]
    probability = sticks_of(alone, EVEN).probability
    chosen = _shown(alone, sticks=probability > EVEN)
    diagnosis = alone[chosen]
    if diagnosis.quantification is not None:
        weighed = Weighed(probability, ())
        diagnosis = with_verdict(diagnosis, parts[chosen], *verdict_of(diagnosis.quantification, weighed))
    diagnosis = replace(
        diagnosis,
        sticks=sticks_of(alone),
        benefit=diagnosis.benefit if diagnosis.verdict == "stiction" else None,
        record=None if diagnosis.record is None else diagnosis.record.counting(window),
        seconds=sum(each.seconds for each in alone),
        stretches=Stretches(
            begin=places[chosen].start * window.ts,
            seconds=len(parts[chosen]) * window.ts,
            whole=len(window) * window.ts,
            verdicts=tuple(each.verdict for each in alone),
            together=probability,
            s=_range_of_s(alone),
        ),
    )
    return diagnosis, parts[chosen]


def _shown(alone: Sequence[Diagnosis], *, sticks: bool) -> int:
    """Return which stretch gives the numbers.

    Of a valve that ``sticks``, that with the S at which half of the information is reached. Of others one of
    the most frequent verdict and cause, with the middle one of their probabilities.
    """
    sizes = _sizes(alone) if sticks else {}
    if sizes:
        places = sorted(sizes, key=lambda k: sizes[k].value)
        reached = np.cumsum([_information(sizes[k], alone[k].record) for k in places])
        return places[int(np.searchsorted(reached, reached[-1] / 2))]
    testable = [k for k, each in enumerate(alone) if each.verdict != "not_testable"] or range(len(alone))
    kinds = Counter((alone[k].verdict, alone[k].cause) for k in testable)
    most = max(kinds, key=lambda kind: kinds[kind])
    alike = [k for k in testable if (alone[k].verdict, alone[k].cause) == most]
    return sorted(alike, key=lambda k: alone[k].probability or 0.0)[len(alike) // 2]


def _sizes(alone: Sequence[Diagnosis]) -> dict[int, IntervalEstimate]:
    """Return S by the stretches that alone show stiction; where none does, by all that have one."""
    firm = [k for k, each in enumerate(alone) if each.verdict == "stiction"] or range(len(alone))
    found = {k: alone[k].quantification for k in firm}
    return {k: each.stiction.s for k, each in found.items() if each is not None and each.stiction is not None}


def _range_of_s(alone: Sequence[Diagnosis]) -> tuple[float, float] | None:
    """Return the least and the largest S of the stretches that alone show stiction, OP units."""
    found = [each.quantification for each in alone if each.verdict == "stiction"]
    sizes = [each.stiction.s.value for each in found if each is not None and each.stiction is not None]
    return (min(sizes), max(sizes)) if sizes else None


def _information(s: IntervalEstimate, record: RecordSummary | None) -> float:
    """Return what a stretch knows of S, over spans of OP squared; an open end is as far away as OP moves."""
    span = 1.0 if record is None or record.op_span <= 0 else record.op_span
    width = (span if s.high is None else s.high) - (s.low or 0.0)
    return 1 / max(width / span, LEAST_WIDTH) ** 2
