"""Process whose gain changes at an instant: fouling, a by-pass opened, another product."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Solved, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

EDGE = 0.1
"""Share of the record at either end that is too short to show another gain."""


@dataclass(frozen=True, slots=True)
class GainChange:
    """A larger or smaller response from an instant on; the amount is solved for.

    At one OP the change makes no difference: where the flow is zero, or where the load balances it. OP and PV
    do not show this OP, so it is searched; the level changes with its distance from the OP at the instant.
    PV follows the new gain with a lag, the process's own where its inflow changed.
    """

    name: str = "gain_change"
    family: str = "gain"
    stage: Stage = "disturbance"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the instant, where the change makes no difference, and the lag.

        The second is counted from the mean response before the instant, in spans of the response.
        """
        first, last = EDGE * facts.duration, (1 - EDGE) * facts.duration
        return (
            Parameter("time", "s", first, last, of_record=True),
            Parameter("pivot", "1", -1.0, 1.0, of_record=True),
            Parameter("tau", "s", 0.0, facts.period, natural=True),
        )

    def solved(self, coefficients: FloatArray, gain: float) -> dict[str, Solved]:
        """Return the gain after the instant, and over that before."""
        after = gain + float(coefficients[0])
        return {"gain_after": (after, "PV/OP"), "ratio": (after / gain if gain else 0.0, "1")}

    def columns(self, time: FloatArray, response: FloatArray, values: FloatArray) -> FloatArray:
        """Return the response after the instant, zero before, (n, 1).

        A first-order process that is at y0 when its inflow begins to count more adds y - y0 exp(-t / tau).
        """
        instant, pivot, tau = (float(value) for value in values)
        after = time > instant
        off = response - response[~after].mean() - pivot * np.ptp(response)
        left = np.exp(-np.maximum(time - instant, 0.0) / tau) if tau > 0.0 else 0.0
        changed = np.where(after, off - off[~after][-1] * left, 0.0)
        return np.asarray(changed[:, np.newaxis])
