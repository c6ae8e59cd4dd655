"""How far one simulated output runs from the measured PV."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.processes.output_error import FEWEST_ROWS

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray


def mean_squared_error(model: FloatArray, pv: FloatArray) -> float:
    """Return the mean squared difference where both are known, PV units squared, or infinity.

    Infinite where ``model`` and ``pv``, PV units, (n,), are both known in too few samples.
    """
    difference = pv - model
    difference = difference[~np.isnan(difference)]
    return float(np.mean(difference**2)) if difference.size >= FEWEST_ROWS else np.inf
