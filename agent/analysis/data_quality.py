"""How good a record is for a verdict on its valve, and what to record instead."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from agent.analysis.gates.rhythm import ADVISED_SAMPLES, FEWEST_SAMPLES
from agent.analysis.indices.service import TimeAtLimit
from agent.analysis.record.compression import DESTROYS, compression_factor

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import LoopWindow

Flaw = Literal["coarse", "compressed", "gaps", "manual", "saturated", "short"]
PERIODS = 15.0
"""To record: ``free_run`` searches a record of fewer than 13 periods sample by sample, and detectors that
average over cycles want ten or more (``methods.md`` 3)."""
SHIFT = 8 * 3600.0
"""To record where no period is known, s: a loop that is disturbed at all is disturbed within a shift."""
MANY_GAPS = 5.0
"""Share of gaps that is a flaw, %: each one hides a stroke."""
MUCH_MANUAL = 20.0
"""Share not in automatic that is a flaw, %."""
MUCH_AT_LIMIT = 5.0
"""Share of the time with OP at a limit that is a flaw, %: the valve does not move then."""


@dataclass(frozen=True, slots=True)
class DataQuality:
    """What the record of one loop is like. Shares are parts of its samples, %."""

    ts: float
    """s."""
    samples: int
    samples_per_period: float | None
    """None where nothing oscillates."""
    compression: float | None
    """Factor by which a historian compressed PV, >= 1; None where it cannot be estimated."""
    gaps_percent: float
    """Without OP or PV, of those in automatic."""
    manual_percent: float | None
    """Not in automatic; None where the mode is not known."""
    at_limit_percent: float | None
    """With OP at a limit; None where it cannot be seen."""
    flaws: tuple[Flaw, ...]
    """What spoils a verdict; empty where nothing does."""
    record_ts: float | None
    """Sampling time to record with instead, s; None where this one is good or no period is known."""
    record_for: float
    """How long to record, s."""

    @property
    def duration(self) -> float:
        """Return the length of the record, s."""
        return self.ts * self.samples


def data_quality(window: LoopWindow, diagnosis: Diagnosis) -> DataQuality:
    """Return the quality of a window; its diagnosis knows the period."""
    per_period = diagnosis.samples_per_period
    period = None if per_period is None else per_period * window.ts
    record = diagnosis.record
    gaps = 100 * float(np.mean(~window.valid)) if record is None else 100 * record.gaps / max(1, len(window))
    manual = diagnosis.manual_percent
    at_limit = TimeAtLimit().of(window, None)
    compression = compression_factor(window.pv)
    wanted = SHIFT if period is None else PERIODS * period
    flawed: dict[Flaw, bool] = {
        "coarse": per_period is not None and per_period < FEWEST_SAMPLES,
        "compressed": compression is not None and compression >= DESTROYS,
        "gaps": gaps > MANY_GAPS,
        "manual": manual is not None and manual > MUCH_MANUAL,
        "saturated": "op_saturated" in diagnosis.gates or (at_limit or 0.0) > MUCH_AT_LIMIT,
        "short": period is not None and window.ts * len(window) < wanted / 3,
    }
    flaws = tuple(name for name, holds in flawed.items() if holds)
    return DataQuality(
        ts=window.ts,
        samples=len(window),
        samples_per_period=per_period,
        compression=compression,
        gaps_percent=gaps,
        manual_percent=manual,
        at_limit_percent=at_limit,
        flaws=flaws,
        record_ts=period / ADVISED_SAMPLES if period is not None and "coarse" in flaws else None,
        record_for=wanted,
    )
