"""The form of every process between valve and PV, and the parameters that they share."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ProcessParameter:
    """One number of a process."""

    name: str
    unit: str
    least: float
    """In ``unit``, allowed itself; there is no upper bound but that it be finite."""


TAU = ProcessParameter("tau", "samples", least=0.2)
"""A lag of 0.2 samples has ended, to 0.7 %, after one sample: a record does not show a shorter one."""
TAU2 = ProcessParameter("tau2", "samples", least=TAU.least)
DELAY = ProcessParameter("delay", "samples", least=1.0)
"""Dead time plus the sample for which a position is held."""


@dataclass(frozen=True, slots=True)
class UnitGainProcess:
    """A linear process of gain (or slope) one."""

    name: str
    parameters: tuple[ProcessParameter, ...]
    """In the order in which ``kernel`` and ``respond`` take their values."""
    kernel: Callable[..., None]
    """Compiled loop ``kernel(position, level, *parameters, out)``."""

    def respond(self, position: FloatArray, parameters: Sequence[float]) -> FloatArray:
        """Return the deviation of PV from where it rested at position(0), shape (n,).

        Unit: that of OP; of an integrator OP units times samples. NaN from a missing position on.

        Args:
            position: Valve position, OP units, shape (n,).
            parameters: Values in the order of ``self.parameters``.

        Raises:
            ValueError: There are too many or too few parameters, or one is out of bounds.
        """
        values = [float(value) for value in parameters]
        if len(values) != len(self.parameters):
            raise ValueError(f"{self.name} takes {len(self.parameters)} parameters, got {len(values)}")
        for parameter, value in zip(self.parameters, values, strict=True):
            if not (math.isfinite(value) and value >= parameter.least):
                raise ValueError(
                    f"{parameter.name} of {self.name} must be at least {parameter.least:g} "
                    f"{parameter.unit} and finite, got {value:g}"
                )
        held = np.ascontiguousarray(position, dtype=np.float64)
        out = np.empty_like(held)
        level = float(held[0]) if held.size else 0.0
        self.kernel(held, level, *values, out)
        return out
