"""Decides cheaply whether a window is worth a full diagnosis; pure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from agent.analysis.gates import ALL_KINDS, closed_kinds, gates
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.reversals import significant_reversals
from agent.analysis.results import Oscillation
from agent.analysis.stiction import detect_stiction

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import MethodResult

ENOUGH_REVERSALS = 8
"""Reversals of OP after which a valve that sticks shows it, also without a steady oscillation."""


@dataclass(frozen=True, slots=True)
class Trigger:
    """Whether to diagnose, and why."""

    fires: bool
    oscillation: Oscillation
    reversals: int
    """Reversals of OP that stand out of its noise."""
    methods: dict[str, MethodResult]
    """What each stiction detector says, by its name."""


def trigger(window: LoopWindow) -> Trigger:
    """Look at a window.

    It fires where the loop oscillates, where OP travels to and fro often enough, where a detector says
    stiction, and where the window is not testable: then the diagnosis says why. Takes some 50 ms for 1500
    samples, so it is for a worker process, not for the event loop.
    """
    oscillation = detect_oscillation(window)
    reversals = significant_reversals(window.op)
    faults = gates(window, oscillation)
    if closed_kinds(faults) == ALL_KINDS:
        return Trigger(True, oscillation, reversals, {})
    methods = {
        name: replace(each, seen=None)  # for pictures only; it would have to travel between processes
        for name, each in detect_stiction(window, oscillation, faults).items()
    }
    accused = any(each.verdict == "stiction" for each in methods.values())
    fires = oscillation.detected or reversals >= ENOUGH_REVERSALS or accused
    return Trigger(fires, oscillation, reversals, methods)
