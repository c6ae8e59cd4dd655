"""A linear output-error model of order three: what a rig's model must do as well as.

Level and initial state are solved for, in the fit as on the other record.
Source: L. Ljung, System Identification, 2nd ed., 4.2 and 10.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import least_squares

from agent.physics.bases.steiglitz_mcbride import DELAYS, in_motion, in_turns

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

ORDER = 3
FAR = 1e3
"""Deviations of PV by which an unstable model counts as wrong."""


@dataclass(frozen=True, slots=True)
class OutputError:
    """A fitted one."""

    top: FloatArray
    bottom: FloatArray
    delay: int
    """Samples."""
    op: float
    """Level that its moves are counted from, OP units."""

    def rmse_on(self, op: FloatArray, pv: FloatArray) -> float:
        """Return the error in free run on another record, (n,), whose level and initial state are its own."""
        left = in_motion(self.top, self.bottom, self.delay, op - self.op, pv)
        return float(np.sqrt(np.mean(left**2)))


def output_error(op: FloatArray, pv: FloatArray) -> OutputError:
    """Fit a model to a record, (n,), of all dead times the one with the least error."""
    moves, found = op - op[0], []
    for delay in range(DELAYS):
        _, top, bottom = in_turns(moves, pv, ORDER, delay)

        def left(at: FloatArray, delay: int = delay) -> FloatArray:
            bottom = np.concatenate(([1.0], at[ORDER:]))
            if np.any(np.abs(np.roots(bottom)) >= 1):
                return np.full(len(pv), FAR * np.std(pv))
            return in_motion(at[:ORDER], bottom, delay, moves, pv)

        solved = least_squares(left, np.concatenate((top, bottom[1:])), max_nfev=200)
        found.append((solved.cost, delay, solved.x))
    _, delay, at = min(found, key=lambda each: each[0])
    return OutputError(at[:ORDER], np.concatenate(([1.0], at[ORDER:])), delay, float(op[0]))
