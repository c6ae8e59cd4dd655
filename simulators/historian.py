"""What a historian keeps of a run: every so many samples, and of each signal only what leaves a band.

Controllers act every second or faster; historians keep a sample every 5 to 60 s, and exception reporting
sends nothing as long as a value stays near the last one that was sent.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.plant import SimulatedRecord


@dataclass(frozen=True, slots=True)
class Historian:
    """How a run is kept."""

    every: int = 1
    """Samples of the run to one that is kept."""
    pv_band: float = 0.0
    """Change of PV up to which the last value is repeated, PV units."""
    op_band: float = 0.0
    """Likewise of OP, OP units."""


def kept(record: SimulatedRecord, historian: Historian) -> SimulatedRecord:
    """Return what the historian keeps of a run, (n / every,)."""
    step = historian.every
    return replace(
        record,
        time=record.time[::step],
        op=reported(record.op, historian.op_band)[::step],
        pv=reported(record.pv, historian.pv_band)[::step],
        sp=record.sp[::step],
        mv=record.mv[::step],
    )


def reported(values: NDArray[np.float64], band: float) -> NDArray[np.float64]:
    """Return ``values`` (n,), each repeated until one differs from it by more than ``band``."""
    if band <= 0:
        return values
    sent = values.copy()
    for i in range(1, len(sent)):
        if abs(values[i] - sent[i - 1]) <= band:
            sent[i] = sent[i - 1]
    return sent
