"""The diagnosis of a window in which nothing happened that a valve could be blamed for."""

from __future__ import annotations

from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import CauseShare, Diagnosis, MethodResult, Oscillation

CONFIDENCE = 0.5
"""A valve that hardly moved cannot show much of itself."""


def quiet(window: LoopWindow, oscillation: Oscillation, methods: dict[str, MethodResult]) -> Diagnosis:
    """Say so of a testable window that neither oscillates nor moves its valve to and fro."""
    return Diagnosis(
        loop=window.loop,
        verdict="no_stiction",
        confidence=CONFIDENCE,
        cause="no_oscillation",
        causes=(CauseShare("no_oscillation", 1.0),),
        stiction_class=None,
        reasons=("the loop shows no regular oscillation, and OP does not travel to and fro",),
        oscillation=oscillation,
        quantification=None,
        methods=methods,
    )
