"""A linear output-error model of order three: what a rig's model must do as well as.

Source: L. Ljung, System Identification, 2nd ed., 4.2 and 10.2; first values by K. Steiglitz and L. McBride,
IEEE Transactions on Automatic Control 10 (1965) 461.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

ORDER = 3
DELAYS = 16
"""Samples of dead time that are tried, from none on."""
TURNS = 30
"""Of first values."""
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
        ran = _run(self.top, self.bottom, op - self.op, self.delay)
        ones = np.eye(ORDER, len(op))
        own = [np.ones(len(op)), *(lfilter([1.0], self.bottom, each) for each in ones)]
        columns = np.column_stack(own)
        left = pv - ran
        left = left - columns @ np.linalg.lstsq(columns, left, rcond=None)[0]
        return float(np.sqrt(np.mean(left**2)))


def output_error(op: FloatArray, pv: FloatArray) -> OutputError:
    """Fit a model to a record, (n,), of all dead times the one with the least error."""
    moves, found = op - op[0], []
    for delay in range(DELAYS):
        level = float(np.mean(pv[:ORDER]))
        first = _first(moves, pv - level, delay)

        def left(at: FloatArray, delay: int = delay) -> FloatArray:
            bottom = np.concatenate(([1.0], at[ORDER : 2 * ORDER]))
            if np.any(np.abs(np.roots(bottom)) >= 1):
                return np.full(len(pv), FAR * np.std(pv))
            return np.asarray(pv - at[-1] - _run(at[:ORDER], bottom, moves, delay), dtype=np.float64)

        solved = least_squares(left, np.concatenate((first, [level])), max_nfev=200)
        found.append((solved.cost, delay, solved.x))
    _, delay, at = min(found, key=lambda each: each[0])
    return OutputError(at[:ORDER], np.concatenate(([1.0], at[ORDER : 2 * ORDER])), delay, float(op[0]))


def _first(moves: FloatArray, pv: FloatArray, delay: int) -> FloatArray:
    """Return first values of numerator and denominator, (2 ORDER,): least squares behind its own filter."""
    bottom, best = np.eye(1, ORDER + 1)[0], (np.inf, np.zeros(2 * ORDER))
    start = ORDER + delay
    for _ in range(TURNS):
        seen, shown = (lfilter([1.0], bottom, each) for each in (moves, pv))
        rows = [-shown[start - 1 - i : len(pv) - 1 - i] for i in range(ORDER)]
        rows += [seen[start - delay - i : len(pv) - delay - i] for i in range(ORDER)]
        solved = np.linalg.lstsq(np.array(rows).T, shown[start:], rcond=None)[0]
        bottom, top = _stable(np.concatenate(([1.0], solved[:ORDER]))), solved[ORDER:]
        error = float(np.sum((pv - _run(top, bottom, moves, delay)) ** 2))
        if error < best[0]:
            best = error, np.concatenate((top, bottom[1:]))
    return best[1]


def _stable(bottom: FloatArray) -> FloatArray:
    """Return a denominator with its poles within the unit circle."""
    poles = np.roots(bottom)
    outside = np.abs(poles) >= 1
    poles[outside] = 0.999 / np.conj(poles[outside])
    return np.real(np.poly(poles))


def _run(top: FloatArray, bottom: FloatArray, moves: FloatArray, delay: int) -> FloatArray:
    late = np.concatenate((np.zeros(delay), moves))[: len(moves)]
    return np.asarray(lfilter(top, bottom, late), dtype=np.float64)
