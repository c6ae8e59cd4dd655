"""Why PV does not respond to OP, as far as one record shows it.

PV that is exactly constant is no measurement: the transmitter holds its last value or has failed to the end
of its range; at zero it may also be the cut-off of a flow that has stopped, which is certain
only where it fell more slowly than a transmitter fails. PV whose noise is alive is measured: at zero nothing
flows (pump off, block valve closed); elsewhere the valve is stuck, by-passed or blocked, which OP and PV do
not distinguish, unless it slips at last.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from agent.analysis.response.stretches import noise_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray

NoResponseCause = Literal["dead_transmitter", "no_flow", "no_signal_or_flow", "stuck_valve", "unknown"]

ZERO_SHARE = 0.01
"""PV nearer to zero than this part of its largest value is at zero: the usual cut-off of a flow."""
ZERO_NOISES = 4.0
"""And so is PV within so many standard deviations of its noise."""
ZERO_MOST = 0.05
"""But never farther than this part of its largest value."""
MOSTLY = 0.5
"""Part of the stretch for which it must be at zero: PV falls first."""
ABRUPT = 2
"""Samples within which a transmitter fails; a flow takes longer to stop."""
SLIP = 6.0
"""Standard deviations of the noise that a slip exceeds."""
SLIP_SAMPLES = 10
"""Samples before and after, of which the medians are compared."""


@dataclass(frozen=True, slots=True)
class Standing:
    """A stretch of a record in which PV does not respond."""

    pv: FloatArray
    """PV of the record, PV units, (n,), NaN where it is missing."""
    begin: int
    end: int
    """First sample, and first one after the stretch."""
    exact: bool
    """Whether PV is exactly constant."""
    wanted: float
    """Direction in which PV should have gone, 1 or -1; 0: not known."""

    @property
    def level(self) -> float:
        """Median of PV in the stretch, PV units."""
        return float(np.nanmedian(self.pv[self.begin : self.end]))


def why_not(standing: Standing) -> NoResponseCause:
    """Return the cause."""
    at_zero = _at_zero(standing)
    if standing.exact:
        if not at_zero:
            return "dead_transmitter"
        return "no_signal_or_flow" if _came_abruptly(standing) else "no_flow"
    if at_zero:
        return "no_flow"
    return "stuck_valve" if slips_after(standing) else "unknown"


def slips_after(standing: Standing) -> bool:
    """Whether PV jumps at the end of the stretch, to the side to which OP pulled."""
    before = standing.pv[max(standing.begin, standing.end - 3 * SLIP_SAMPLES) : standing.end]
    after = standing.pv[standing.end : standing.end + 3 * SLIP_SAMPLES]
    before, after = before[np.isfinite(before)], after[np.isfinite(after)]
    if min(len(before), len(after)) < SLIP_SAMPLES // 2 or not standing.wanted:
        return False
    moves = after - np.median(before)
    farthest = float(moves[np.argmax(np.abs(moves))])
    return abs(farthest) > SLIP * noise_of(standing.pv[standing.begin : standing.end]) and (
        farthest * standing.wanted > 0
    )


def near_zero(pv: FloatArray, noise: float) -> NDArray[np.bool_]:
    """Return where PV (n,) with so much noise (standard deviation) is at zero, (n,); false at gaps."""
    known = np.abs(pv[np.isfinite(pv)])
    largest = float(known.max()) if known.size else 0.0
    with np.errstate(invalid="ignore"):
        return np.abs(pv) <= max(ZERO_SHARE * largest, min(ZERO_NOISES * noise, ZERO_MOST * largest))


def _at_zero(standing: Standing) -> bool:
    here = standing.pv[standing.begin : standing.end]
    here = here[np.isfinite(here)]
    return bool(np.mean(near_zero(standing.pv, noise_of(here))[standing.begin : standing.end]) > MOSTLY)


def _came_abruptly(standing: Standing) -> bool:
    """Whether PV was far from its level just before; not where the record begins with the stretch."""
    before = standing.pv[max(0, standing.begin - ABRUPT - 1) : standing.begin]
    before = before[np.isfinite(before)]
    if not before.size:
        return False
    way = float(np.nanmax(np.abs(standing.pv - standing.level)))
    return abs(float(before[0]) - standing.level) > 0.5 * way
