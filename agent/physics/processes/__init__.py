"""Low-order processes between valve and PV, one a file."""

from __future__ import annotations

from agent.physics.processes.fopdt import fopdt
from agent.physics.processes.integrator import integrator
from agent.physics.processes.process import DELAY, TAU, TAU2, ProcessParameter, UnitGainProcess
from agent.physics.processes.sopdt import sopdt

__all__ = ["PROCESSES", "ProcessParameter", "UnitGainProcess"]

PROCESSES: tuple[UnitGainProcess, ...] = (
    UnitGainProcess("fopdt", (TAU, DELAY), fopdt),
    UnitGainProcess("sopdt", (TAU, TAU2, DELAY), sopdt),
    UnitGainProcess("integrator", (DELAY,), integrator),
)
