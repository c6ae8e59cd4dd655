"""The diagnosis of a window in which nothing happened that a valve could cause.

Where PV does not respond to OP, that says nothing of the valve: it may be stuck.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.diagnosis import Diagnosis, RecordSummary
from agent.analysis.indices import performance
from agent.analysis.results import CauseShare
from agent.analysis.seen import without_pictures

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.seen import Seen

CONFIDENCE = 0.5
"""A valve that hardly moved cannot show much of itself."""


def quiet(window: LoopWindow, seen: Seen) -> Diagnosis:
    """Return the diagnosis of a testable window that neither oscillates nor moves OP beyond its noise."""
    return Diagnosis(
        loop=window.loop,
        verdict="no_stiction" if seen.no_response is None else "undecided",
        confidence=CONFIDENCE if seen.no_response is None else 0.0,
        cause="no_oscillation",
        causes=(CauseShare("no_oscillation", 1.0),),
        stiction_class=None,
        oscillation=seen.oscillation,
        quantification=None,
        methods=without_pictures(seen.methods),
        record=RecordSummary.of(window, seen.oscillation),
        indices=performance(window, None),
        quiet=True,
        no_response=seen.no_response,
        as_before=seen.as_before,
    )
