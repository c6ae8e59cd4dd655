"""The cross-correlation of OP and PV: odd when the valve sticks, even when it does not.

Source: A. Horch, "A simple method for detection of stiction in control valves", Control Engineering Practice
7 (1999) 1221; reference ``methods.md`` 3.1, where the decision rule is derived.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import signal

from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.stretch import longest_stretch

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

ODD_RHO, ODD_TAU = 1 / 3, 2 / 3
"""Beyond both the correlation is odd: the phase is within pi/6 of pi/2."""
EVEN_RHO, EVEN_TAU = (2 - np.sqrt(3)) / (2 + np.sqrt(3)), 1 / 3
"""Below both it is even: the phase is within pi/6 of pi."""
FEWEST_PERIODS = 5.0


@dataclass(frozen=True, slots=True)
class CrossCorrelation:
    """What the detector measured."""

    lag: FloatArray
    """Samples, one period to each side, (2m + 1,)."""
    r: FloatArray
    """Correlation coefficient of OP now and PV a lag later, (2m + 1,)."""
    left: float
    """Distance of the first zero crossing at negative lag, samples."""
    right: float
    """The same at positive lag."""
    delta_rho: float
    delta_tau: float


@dataclass(frozen=True, slots=True)
class HorchCcf:
    """For self-regulating loops under PI control: a sticking valve makes OP and PV a quarter period apart."""

    name: str = "horch_ccf"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge by the rule of Horch (1999); the index is delta tau, 0 for even and 1 for odd."""
        if window.hints.integrating:
            return MethodResult(
                "not_applicable", None, "the correlation is always odd in an integrating loop"
            )
        stretch = longest_stretch(window)
        if oscillation.period is None or len(stretch) * window.ts < FEWEST_PERIODS * oscillation.period:
            return MethodResult("not_applicable", None, f"fewer than {FEWEST_PERIODS:.0f} periods in a row")
        seen = cross_correlation(stretch.op, stretch.pv, round(oscillation.period / window.ts))
        if seen is None:
            return MethodResult("undecided", None, "the correlation of OP and PV does not cross zero")
        found = f"delta rho {seen.delta_rho:.2f}, delta tau {seen.delta_tau:.2f}"
        if seen.delta_rho > ODD_RHO and seen.delta_tau > ODD_TAU:
            return MethodResult("stiction", seen.delta_tau, f"the correlation is odd: {found}", seen)
        if seen.delta_rho < EVEN_RHO and seen.delta_tau < EVEN_TAU:
            return MethodResult("no_stiction", seen.delta_tau, f"the correlation is even: {found}", seen)
        return MethodResult(
            "undecided",
            seen.delta_tau,
            f"the correlation is neither odd nor even: {found}",
            seen,
        )


def cross_correlation(op: FloatArray, pv: FloatArray, most: int) -> CrossCorrelation | None:
    """Correlate ``op`` and ``pv`` (n,) up to ``most`` samples to each side; None where no sign changes."""
    u, y = signal.detrend(op), signal.detrend(pv)
    scale = float(np.sqrt(np.sum(u**2) * np.sum(y**2)))
    if scale == 0:
        return None
    middle = len(op) - 1
    whole = signal.correlate(y, u, mode="full") / scale
    r = np.asarray(whole[middle - most : middle + most + 1], dtype=np.float64)
    right, left = _first_crossing(r[most:]), _first_crossing(r[most::-1])
    if right is None or left is None:
        return None
    r_0 = abs(float(r[most]))
    r_opt = float(np.max(np.abs(r[most - int(left) : most + int(right) + 1])))
    return CrossCorrelation(
        lag=np.arange(-most, most + 1, dtype=np.float64),
        r=r,
        left=left,
        right=right,
        delta_rho=(r_opt - r_0) / (r_opt + r_0),
        delta_tau=abs(left - right) / (left + right),
    )


def _first_crossing(r: FloatArray) -> float | None:
    """Return where ``r`` first changes its sign, in samples from its start, between samples by a line."""
    changes = np.flatnonzero(np.signbit(r[1:]) != np.signbit(r[:-1]))
    if not changes.size:
        return None
    k = int(changes[0])
    return float(k + r[k] / (r[k] - r[k + 1]))
