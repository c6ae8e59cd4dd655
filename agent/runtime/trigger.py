"""Decides cheaply whether a window is worth a full diagnosis; pure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.analysis.gates import ALL_KINDS, closed_kinds, gates
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.results import Oscillation
from agent.analysis.reversals import significant_reversals

if TYPE_CHECKING:
    from agent.analysis.recording import LoopWindow

ENOUGH_REVERSALS = 8
"""Reversals of OP after which a valve that sticks shows it, also without a steady oscillation."""


@dataclass(frozen=True, slots=True)
class Trigger:
    """Whether to diagnose, and why."""

    fires: bool
    oscillation: Oscillation
    reversals: int
    """Reversals of OP that stand out of its noise."""


def trigger(window: LoopWindow) -> Trigger:
    """Look at a window.

    It fires where the loop oscillates, where OP travels to and fro often enough, and where the window is not
    testable: then the diagnosis says why.
    """
    oscillation = detect_oscillation(window)
    reversals = significant_reversals(window.op)
    testable = closed_kinds(gates(window, oscillation)) != ALL_KINDS
    fires = oscillation.detected or reversals >= ENOUGH_REVERSALS or not testable
    return Trigger(fires, oscillation, reversals)
