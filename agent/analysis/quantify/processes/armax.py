"""ARMAX by extended least squares, with a bias that may walk (EARMAX).

    y(t) = a1 y(t-1) + a2 y(t-2) + b1 x(t-D) + b2 x(t-D-1) + e(t) + c1 e(t-1) + c2 e(t-2) + eta(t)
    eta(t) = eta(t-1) + w(t),    var w = walk^2 var e

Extended least squares (Young 1968; Panuska 1968): the residual of the last fit is used for e in the next
regression, beginning with the fit without e. That need not converge: a step that makes the record less likely
is halved, and where that does not help the search ends.
The bias is that of Karra and Karim (2009): a Kalman filter of eta run over PV and over each regressor leaves
the part that eta cannot follow, and ordinary least squares on that part is the exact estimate beside a walk
(Rosenberg 1973). With walk = 0 eta is a constant level and the model plain ARMAX.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.quantify.processes.least_squares import solve_normal_equations
from agent.analysis.quantify.processes.output_error import FIRST_ORDER, INTEGRATOR
from agent.jit import kernel
from agent.physics.processes.arx import Arx, simulate_arx

if TYPE_CHECKING:
    from numpy.typing import NDArray

SWEEPS = 8
"""Regressions at most."""
HALVINGS = 4
"""Shares of a step, down to an eighth, of which one must raise the likelihood."""


class Armax(NamedTuple):
    """A fitted model. Where there is none its gain is NaN and ``aic`` infinite."""

    process: Arx
    """Its bias is zero: eta has it."""
    c1: float
    c2: float
    eta: NDArray[np.float64]
    """Bias given the whole record, PV units, (n,)."""
    variance: float
    """Of e, PV units squared."""
    aic: float
    """Akaike's criterion: -2 log likelihood + 2 parameters."""


@kernel
def fit_armax(
    mv: NDArray[np.float64],
    pv: NDArray[np.float64],
    delay: int,
    structure: int,
    noise_order: int,
    walk: float,
) -> Armax:
    """Fit one model; ``mv`` and ``pv`` about their means, OP and PV units, (n,).

    Rows with a missing sample are left out. Where e before them is not known it counts as zero, its mean.

    Args:
        mv: Valve position, OP units, shape (n,).
        pv: Process variable, PV units, shape (n,).
        delay: D, samples.
        structure: INTEGRATOR (a1 = 1, a2 = b2 = 0), FIRST_ORDER (a2 = b2 = 0) or SECOND_ORDER.
        noise_order: Number of the c, 0 to 2.
        walk: Step of eta over the standard deviation of e.
    """
    rows = _rows(mv, pv, delay, structure, noise_order)
    columns = rows.shape[1] - 1
    linear = columns - noise_order
    best = np.zeros(columns)
    best[0] = np.nan
    least = np.inf
    for sweep in range(SWEEPS if noise_order > 0 else 1):
        # The noise columns are zero at first: then only the others are fitted.
        width = linear if sweep == 0 else columns
        weights = np.zeros(columns)
        weights[:width] = _least_squares(rows, width, walk)
        if np.isnan(weights[0]):
            break
        criterion = np.inf
        for _ in range(HALVINGS):
            if _invertible(weights[linear:]):
                criterion = _filter(rows, weights, noise_order, walk)[2]
            if sweep == 0 or criterion < least:
                break
            weights = (weights + best) / 2.0
        if not criterion < least:
            break
        best, least = weights, criterion
    variance, eta, _ = _filter(rows, best, noise_order, walk)
    return Armax(
        _process(best, structure, delay),
        best[linear] if noise_order > 0 else 0.0,
        best[linear + 1] if noise_order > 1 else 0.0,
        eta,
        variance,
        least + 2.0 * (columns + 2),  # eta and the variance are parameters too
    )


@kernel
def free_run(model: Armax, mv: NDArray[np.float64], pv: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the output simulated from ``mv`` and eta as ``simulate_arx`` does, PV units, (n,)."""
    process = model.process
    load = np.zeros(pv.size)
    for t in range(2, pv.size):
        load[t] = process.a1 * load[t - 1] + process.a2 * load[t - 2] + model.eta[t]
    return load + simulate_arx(process, mv, pv - load)


@kernel
def _rows(
    mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int, structure: int, noise_order: int
) -> NDArray[np.float64]:
    """Return the regressors, room for e, and last what they shall explain: (n, 2 to 7), NaN where unknown."""
    linear = 1 if structure == INTEGRATOR else 2 if structure == FIRST_ORDER else 4
    rows = np.full((pv.size, linear + noise_order + 1), np.nan)
    for t in range(delay + 1, pv.size):
        if structure == INTEGRATOR:
            rows[t, 0] = mv[t - delay]
            rows[t, -1] = pv[t] - pv[t - 1]
        elif structure == FIRST_ORDER:
            rows[t, 0] = pv[t - 1]
            rows[t, 1] = mv[t - delay]
            rows[t, -1] = pv[t]
        else:
            rows[t, 0] = pv[t - 1]
            rows[t, 1] = pv[t - 2]
            rows[t, 2] = mv[t - delay]
            rows[t, 3] = mv[t - delay - 1]
            rows[t, -1] = pv[t]
        for column in range(linear, linear + noise_order):
            rows[t, column] = 0.0
        for value in rows[t]:
            if np.isnan(value):
                rows[t, -1] = np.nan
    return rows


@kernel
def _least_squares(rows: NDArray[np.float64], width: int, walk: float) -> NDArray[np.float64]:
    """Return the weights of the first ``width`` columns beside a walking bias; NaN where there are none."""
    bias = np.zeros(width + 1)
    normal = np.zeros((width + 1, width + 1))
    rest = np.empty(width + 1)
    spread = np.inf
    for t in range(rows.shape[0]):
        spread += walk * walk
        if np.isnan(rows[t, -1]):
            continue
        gain = 1.0 if spread == np.inf else spread / (spread + 1.0)
        for i in range(width + 1):
            rest[i] = rows[t, i if i < width else -1] - bias[i]
            bias[i] += gain * rest[i]
        if spread < np.inf:
            for i in range(width + 1):
                for k in range(i + 1):
                    normal[i, k] += rest[i] * rest[k] / (spread + 1.0)
        spread = gain
    for i in range(width):
        for k in range(i):
            normal[k, i] = normal[i, k]
    return solve_normal_equations(normal[:width, :width].copy(), normal[width, :width].copy())


@kernel
def _filter(
    rows: NDArray[np.float64], weights: NDArray[np.float64], noise_order: int, walk: float
) -> tuple[float, NDArray[np.float64], float]:
    """Return the variance of e, eta given all rows (n,) and -2 log likelihood; write e into ``rows``."""
    n, linear = rows.shape[0], weights.size - noise_order
    filtered = np.zeros(n)
    spreads = np.zeros(n)
    squares = determinant = bias = 0.0
    spread = np.inf
    count = 0
    for t in range(n):
        spread += walk * walk
        noise = 0.0
        if not np.isnan(rows[t, -1]):
            gain = 1.0 if spread == np.inf else spread / (spread + 1.0)
            rest = rows[t, -1] - bias
            for i in range(weights.size):
                rest -= weights[i] * rows[t, i]
            bias += gain * rest
            noise = rest * (1.0 - gain)
            if spread < np.inf:
                squares += rest * rest / (spread + 1.0)
                determinant += np.log(spread + 1.0)
                count += 1
            spread = gain
        for k in range(noise_order):
            if t + k + 1 < n and not np.isnan(rows[t + k + 1, linear + k]):
                rows[t + k + 1, linear + k] = noise
        filtered[t] = bias
        spreads[t] = spread
    for t in range(n - 2, -1, -1):
        share = 1.0 if spreads[t] == np.inf else spreads[t] / (spreads[t] + walk * walk)
        later = filtered[t + 1]
        filtered[t] = later if spreads[t] == np.inf else filtered[t] + share * (later - filtered[t])
    variance = squares / count if count > 0 else np.nan
    return variance, filtered, count * (np.log(variance) + 1.0) + determinant


@kernel
def _invertible(c: NDArray[np.float64]) -> bool:
    """Whether e can be computed from PV: the roots of 1 + c1 q^-1 + c2 q^-2 lie within the circle."""
    if c.size == 0:
        return True
    c2 = c[1] if c.size > 1 else 0.0
    return bool(abs(c2) < 1.0 and abs(c[0]) < 1.0 + c2)


@kernel
def _process(weights: NDArray[np.float64], structure: int, delay: int) -> Arx:
    if structure == INTEGRATOR:
        return Arx(1.0, 0.0, weights[0], 0.0, 0.0, delay)
    if structure == FIRST_ORDER:
        return Arx(weights[0], 0.0, weights[1], 0.0, 0.0, delay)
    return Arx(weights[0], weights[1], weights[2], weights[3], 0.0, delay)
