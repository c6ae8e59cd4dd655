"""Low-order processes between valve and PV, one a file."""

from __future__ import annotations

from agent.physics.processes.fopdt import fopdt
from agent.physics.processes.integrator import integrator
from agent.physics.processes.process import DELAY, TAU, TAU2, Process, ProcessParameter
from agent.physics.processes.sopdt import sopdt

__all__ = ["PROCESSES", "Process", "ProcessParameter"]

PROCESSES: tuple[Process, ...] = (
    Process("fopdt", (TAU, DELAY), fopdt),
    Process("sopdt", (TAU, TAU2, DELAY), sopdt),
    Process("integrator", (DELAY,), integrator),
)
