"""The newest fit of a loop as it is kept for the page: some 30 kB in place of 250 to 450.

Opened, it has the window, what the model says at each sample, and the error against S. What the detectors saw
is not kept: the same look at the same window shows it again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

from agent.runtime.loop.packed import Packed

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import LoopWindow


@dataclass(frozen=True, slots=True)
class KeptFit:
    """A window that got a fit, and its diagnosis with all curves."""

    packed: Packed[tuple[LoopWindow, Diagnosis]]
    start: float
    """Of the window, s UTC."""
    seconds: float
    """Its length, s."""

    @classmethod
    def of(cls, window: LoopWindow, diagnosis: Diagnosis) -> Self:
        """Keep the fit of a window."""
        packed = Packed.of((window, diagnosis), squeezed=True)
        return cls(packed, window.start, len(window.time) * window.ts)


def without_curves(diagnosis: Diagnosis) -> Diagnosis:
    """Return what alarms, lists and metrics need of a diagnosis: no array of its fit."""
    found = diagnosis.quantification
    if found is None:
        return diagnosis
    bare = replace(found, model_pv=None, model_mv=None, profile=None, sticking=None)
    return replace(diagnosis, quantification=bare)
