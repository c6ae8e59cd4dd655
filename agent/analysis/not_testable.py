"""The diagnosis of a window to which no method may be applied: it states why, and needs no fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.diagnosis import Diagnosis, RecordSummary
from agent.analysis.indices import performance
from agent.analysis.results import CauseShare

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.seen import Seen


def not_testable(window: LoopWindow, seen: Seen) -> Diagnosis:
    """Return the diagnosis of a window whose gates close all kinds of methods."""
    return Diagnosis(
        loop=window.loop,
        verdict="not_testable",
        confidence=0.0,
        cause="undecided",
        causes=(CauseShare("undecided", 1.0),),
        stiction_class=None,
        oscillation=None,
        quantification=None,
        faults=seen.faults,
        record=RecordSummary.of(window, seen.oscillation),
        indices=performance(window, None),
        no_response=seen.no_response,
        as_before=seen.as_before,
        seconds=seen.seconds,
    )
