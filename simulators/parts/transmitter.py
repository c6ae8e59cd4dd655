"""What a transmitter makes of PV: a root that is not extracted, a pH electrode, a float that rubs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from simulators.parameters import TransmitterParameters

WATER = 1e-14
"""Ion product of water, (mol/l)2."""
ACID = 10**-6.5
"""Constant of the weak acid that buffers, mol/l."""
PH = np.linspace(0.0, 14.0, 14001)
"""Where the charges are balanced."""


class Transmitter:
    """The transmitter of one loop; PV as deviation from the operating point, in OP units of the process."""

    def __init__(self, parameters: TransmitterParameters) -> None:
        self._parameters = parameters
        self._held = 0.0
        hydrogen = 10.0**-PH
        self._base = (
            WATER / hydrogen - hydrogen + parameters.buffer * ACID / (ACID + hydrogen)
        ) / parameters.strength
        self._neutral = float(np.interp(parameters.ph, PH, self._base))
        self._steep = float(np.interp(parameters.ph, PH, np.gradient(PH, self._base)))

    def shown(self, level: float) -> float:
        """Return what is shown of a level, so that at the operating point the slope is one."""
        has = self._parameters
        if has.kind == "square":
            flow = has.flow + level
            level = (flow * abs(flow) - has.flow**2) / (2 * has.flow)
        elif has.kind == "ph":
            level = (float(np.interp(self._neutral + level, self._base, PH)) - has.ph) / self._steep
        if has.dead_band == 0.0:
            return level
        self._held = min(max(self._held, level - 0.5 * has.dead_band), level + 0.5 * has.dead_band)
        return self._held
