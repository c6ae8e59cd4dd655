"""Shares of time: in service, in manual, at a limit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates.op import LIMIT_MARGIN

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow


@dataclass(frozen=True, slots=True)
class ServiceFactor:
    """Time in an automatic mode with usable OP and PV over all time (ISA-TR5.9)."""

    name: str = "service_factor"
    unit: str = "%"
    meaning: str = "time in an automatic mode with usable OP and PV"

    def of(self, window: LoopWindow, delay: float | None) -> float | None:
        """Return the share, %; None where the mode is not known."""
        del delay
        if window.automatic is None or not len(window):
            return None
        return float(100 * np.mean(window.automatic & window.valid))


@dataclass(frozen=True, slots=True)
class TimeInManual:
    """Time in another than an automatic mode over all time."""

    name: str = "time_in_manual"
    unit: str = "%"
    meaning: str = "time in manual or another mode that is not automatic"

    def of(self, window: LoopWindow, delay: float | None) -> float | None:
        """Return the share, %; None where the mode is not known."""
        del delay
        if window.automatic is None or not len(window):
            return None
        return float(100 * np.mean(~window.automatic))


@dataclass(frozen=True, slots=True)
class TimeAtLimit:
    """Time that OP stands at a limit of its range over all time."""

    name: str = "saturation"
    unit: str = "%"
    meaning: str = "time that OP stands at a limit of its range"

    def of(self, window: LoopWindow, delay: float | None) -> float | None:
        """Return the share, %; None where the range of OP is not known."""
        del delay
        op = window.op[np.isfinite(window.op)]
        if window.hints.op_range is None or not op.size:
            return None
        low, high = window.hints.op_range
        margin = LIMIT_MARGIN * (high - low)
        return float(100 * np.mean((op <= low + margin) | (op >= high - margin)))
