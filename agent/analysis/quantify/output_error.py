"""How far a valve and the linear process fitted behind it run from the measured PV.

The paper fits the process by least squares and takes the mean squared error of the model. Taken one step
ahead that error hardly sees stiction (CHEM12: no stiction costs 2 % more than the best valve); of the
simulated output it does (160 % more). So the coefficients come from least squares, the error from simulation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.least_squares import fit_first_order, fit_integrator, fit_second_order
from agent.analysis.quantify.valve_law import valve_position
from agent.jit import kernel
from agent.physics.processes.arx import Arx, simulate_arx

if TYPE_CHECKING:
    from numpy.typing import NDArray

INTEGRATOR, FIRST_ORDER, SECOND_ORDER = 0, 1, 2
"""Structures of the process."""

FEWEST_ROWS = 50
"""Simulated samples below which an error means nothing."""


@kernel
def fit_process(mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int, structure: int) -> Arx:
    """Fit one of the structures; ``mv`` and ``pv`` about their means, OP and PV units, (n,)."""
    if structure == INTEGRATOR:
        return fit_integrator(mv, pv, delay)
    if structure == FIRST_ORDER:
        return fit_first_order(mv, pv, delay)
    return fit_second_order(mv, pv, delay)


@kernel
def plausible(process: Arx, gain_sign: int) -> bool:
    """Whether a plant may be so.

    No pole oscillates or grows, the slowest is positive, PV sets out in the direction in which it ends, and
    the gain has its sign. Least squares yields others when the valve or the delay is wrong. An oscillating
    pole would explain a limit cycle without any valve; b1 and b2 that nearly cancel are the controller,
    inverted. A fast pole may be negative: noise on PV does that to a second order.

    Args:
        process: The fitted process; a NaN in it is not plausible.
        gain_sign: 1 or -1 where the engineer knows it, else 0.
    """
    gain = process.b1 + process.b2
    if np.isnan(gain) or gain_sign * gain < 0 or process.b1 * gain < 0:
        return False
    if process.a1 == 1.0 and process.a2 == 0.0:
        return True  # the integrator, whose pole was not fitted
    discriminant = process.a1 * process.a1 + 4.0 * process.a2
    return process.a1 > 0.0 and discriminant >= 0.0 and (process.a1 + np.sqrt(discriminant)) / 2.0 < 1.0


@kernel
def mean_squared_error(model: NDArray[np.float64], pv: NDArray[np.float64]) -> float:
    """Mean squared difference where both are known, PV units squared; infinite with too few such samples."""
    total = 0.0
    rows = 0
    for t in range(pv.size):
        difference = pv[t] - model[t]
        if not np.isnan(difference):
            total += difference * difference
            rows += 1
    return total / rows if rows >= FEWEST_ROWS else np.inf


@kernel
def output_errors(
    op: NDArray[np.float64],
    pv: NDArray[np.float64],
    bands: NDArray[np.float64],
    delays: NDArray[np.int64],
    structure: int,
    gain_sign: int,
    law: int,
) -> NDArray[np.float64]:
    """Return the mean squared free-run error of each valve and delay, PV units squared, shape (k, d).

    It is infinite where the fitted process is not plausible.

    Args:
        op: Controller output, OP units, shape (n,), at least one sample known.
        pv: Process variable about its mean, PV units, shape (n,).
        bands: f_S and f_D of the valves to try, OP units, shape (k, 2).
        delays: Delays to try, samples, shape (d,).
        structure: INTEGRATOR, FIRST_ORDER or SECOND_ORDER.
        gain_sign: 1 or -1 where the engineer knows it, else 0.
        law: Of the valve, see ``valve_law``.
    """
    errors = np.full((bands.shape[0], delays.size), np.inf)
    for i in range(bands.shape[0]):
        mv = valve_position(op, bands[i, 0], bands[i, 1], law)
        for j in range(delays.size):
            process = fit_process(mv, pv, delays[j], structure)
            if plausible(process, gain_sign):
                errors[i, j] = mean_squared_error(simulate_arx(process, mv, pv), pv)
    return errors
