"""Dead time that depends on the flow: what the valve lets through travels along a pipe of a given volume."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.bases.lag_bases import delay_of
from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

FARTHEST, NEAREST = 2.0, 0.05
"""OP at which nothing flows, below the least OP, spans: from a dead time that hardly changes to one that
changes twentyfold."""
SLOWEST = 1e-3
"""Part of the fastest flow that flows at least, so that the pipe empties."""
ROUNDING = 1e-9
"""Part of all that passes over which no mean differs from the position by more than sums are rounded."""
VOLUME_BY_LAW = 0.25
"""``Parameter.by_law`` of the volume: fronts of another form stand for a part of the dead time. The interval
without it holds 24 of 33 volumes of ``simulators.draws.hidden_effects``, seeds 95250 to 95289, with it 28."""
MOST_SPREAD = 0.4
"""Standard deviation of the time in the pipe, over its mean: of as much as six stirred vessels in a row."""


@dataclass(frozen=True, slots=True)
class TransportDelay:
    """What enters leaves when the volume of the pipe has flowed in behind it, and mixes on its way.

    Of the mixing, the spread of a front over the volume that has passed counts, not its form: the mean over
    two stretches of it, one behind the other, stands for it. The dead time of the base remains as the part
    that does not depend on the flow.
    Source: K. Zenger, A. Niemi, Modelling and control of a class of time-varying continuous flow processes,
    J. Process Control 19 (2009) 1511; O. Levenspiel, Chemical Reaction Engineering (1999), chapters 13, 14.
    """

    name: str = "transport_delay"
    family: str = "process_delay"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the volume, in what one OP unit lets through in a second, the OP of no flow, and the spread.

        The spread of a front is over its way, as of the time of residence: the root of 2 D / (u L).
        """
        fastest = (1.0 + FARTHEST) * facts.op_span
        return (
            Parameter("volume", "OP*s", 0.0, delay_of(facts).high * fastest, null=0.0, by_law=VOLUME_BY_LAW),
            Parameter(
                "no_flow",
                "OP",
                facts.op_low - FARTHEST * facts.op_span,
                facts.op_low - NEAREST * facts.op_span,
                natural=True,
            ),
            Parameter("spread", "1", 0.0, MOST_SPREAD, null=0.0),
        )

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return what leaves the pipe; at the first sample it is full of what enters then."""
        volume, no_flow, spread = (float(value) for value in values)
        flow = position - no_flow
        fastest = float(flow.max())
        if volume == 0.0 or fastest <= 0.0:
            return position
        passed = np.cumsum(np.maximum(flow, SLOWEST * fastest)) * ts
        stretch = spread * volume * math.sqrt(6.0)
        for _ in range(2):
            position = _mean_behind(passed, position, stretch)
        return np.asarray(np.interp(passed - (volume - stretch), passed, position), dtype=np.float64)


def _mean_behind(passed: FloatArray, position: FloatArray, stretch: float) -> FloatArray:
    """Return the mean of a position, (n,), over the ``stretch`` that passed before each sample.

    ``passed``: what has passed until each sample, (n,), growing; before the first the position is the first.
    """
    if stretch <= ROUNDING * (passed[-1] - passed[0]):
        return position
    sums = np.concatenate(([0.0, stretch * position[0]], position[1:] * np.diff(passed))).cumsum()
    start = np.concatenate((passed[:1] - stretch, passed))
    return np.asarray((sums[1:] - np.interp(passed - stretch, start, sums)) / stretch)
