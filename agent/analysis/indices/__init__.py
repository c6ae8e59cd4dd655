"""INDICES: what plants compute of a loop beside the verdict on its valve, with formula and source."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.indices.harris import Harris
from agent.analysis.indices.index import PerformanceIndex
from agent.analysis.indices.mean_absolute_error import MeanAbsoluteError
from agent.analysis.indices.movement import Reversals, SetPointCrossings, Travel
from agent.analysis.indices.service import ServiceFactor, TimeAtLimit, TimeInManual
from agent.analysis.indices.variability import Variability

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

__all__ = ["INDICES", "PerformanceIndex", "performance"]

INDICES: tuple[PerformanceIndex, ...] = (
    MeanAbsoluteError(),
    Variability(),
    Harris(),
    ServiceFactor(),
    TimeInManual(),
    TimeAtLimit(),
    Travel(),
    Reversals(),
    SetPointCrossings(),
)


def performance(window: LoopWindow, delay: float | None) -> dict[str, float | None]:
    """Return each index of a window by its name; None where the window does not determine it.

    Args:
        window: The record.
        delay: Dead time of the process, s; None where it is not known.
    """
    return {each.name: each.of(window, delay) for each in INDICES}
