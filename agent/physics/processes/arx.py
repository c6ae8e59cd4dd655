"""Low-order linear process in the sampled form that least squares can fit.

    y(t) = a1 y(t-1) + a2 y(t-2) + b1 x(t-D) + b2 x(t-D-1) + bias

A first-order process behind a zero-order hold has a2 = b2 = 0, an integrator a1 = 1 and a2 = b2 = 0 as well.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Arx(NamedTuple):
    """Coefficients of the difference equation above. A named tuple, because compiled loops accept these."""

    a1: float
    a2: float
    b1: float
    """PV units per OP unit, like ``b2``."""
    b2: float
    bias: float
    """PV units."""
    delay: int
    """D, samples; y(t) depends first on x(t - D), D >= 1."""


@kernel
def simulate_arx(process: Arx, mv: NDArray[np.float64], pv: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the simulated output, PV units, shape (n,).

    Past outputs are the simulated ones (free run). The measured PV is used only where the model has no past:
    at the start, and after a gap in ``mv``, until it has the two outputs and two inputs that it needs. Those
    samples are NaN in the result: they are not the model's.

    Args:
        process: The difference equation.
        mv: Valve position, OP units, shape (n,); NaN is unknown.
        pv: Measured output to start from, PV units, shape (n,); NaN is missing.
    """
    model = np.full(mv.size, np.nan)
    last = before_last = np.nan
    for t in range(mv.size):
        y = np.nan
        if t > process.delay:
            forced = process.b1 * mv[t - process.delay] + process.b2 * mv[t - process.delay - 1]
            y = process.a1 * last + (process.a2 * before_last + forced + process.bias)
        model[t] = y
        before_last = last
        last = pv[t] if np.isnan(y) else y
    return model
