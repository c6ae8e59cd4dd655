"""From the coefficients of a difference equation to gain, time constants and delay."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agent.analysis.quantify.processes.output_error import FIRST_ORDER, INTEGRATOR
from agent.analysis.results import ProcessEstimate

if TYPE_CHECKING:
    from agent.physics.processes.arx import Arx


def process_estimate(process: Arx, structure: int, ts: float) -> ProcessEstimate:
    """Return a plausible process (see ``output_error``) with times in seconds; ``ts`` is in s."""
    delay = process.delay * ts
    if structure == INTEGRATOR or (process.a1 == 1.0 and process.a2 == 0.0):  # a pole may be fitted as one
        return ProcessEstimate("integrator", gain=process.b1 / ts, tau=None, delay=delay)
    gain = (process.b1 + process.b2) / (1.0 - process.a1 - process.a2)
    root = math.sqrt(process.a1 * process.a1 + 4.0 * process.a2)
    slow, fast = (process.a1 + root) / 2.0, (process.a1 - root) / 2.0
    tau = -ts / math.log(slow)
    if structure == FIRST_ORDER:
        return ProcessEstimate("fopdt", gain=gain, tau=tau, delay=delay)
    tau2 = -ts / math.log(fast) if fast > 0 else None  # a pole of noise stands for no lag
    return ProcessEstimate("sopdt", gain=gain, tau=tau, delay=delay, tau2=tau2)
