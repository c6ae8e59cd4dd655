"""How far a valve and the linear process fitted behind it run from the measured PV.

The paper fits the process by least squares and takes the mean squared error of the model. Taken one step
ahead that error hardly sees stiction (CHEM12: no stiction costs 2 % more than the best valve); of the
simulated output it does (160 % more). So the coefficients come from least squares, the error from simulation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.processes.least_squares import fit_first_order, fit_integrator, fit_second_order
from agent.analysis.quantify.valves.valve_law import valve_position
from agent.jit import kernel
from agent.physics.processes.arx import Arx

if TYPE_CHECKING:
    from numpy.typing import NDArray

INTEGRATOR, FIRST_ORDER, SECOND_ORDER = 0, 1, 2
"""Structures of the process."""

FEWEST_ROWS = 50
"""Simulated samples below which an error has no meaning."""
SIDE_BY_SIDE = 32
"""Valves taken together; more are no faster, fewer leave the processor waiting."""


@kernel
def fit_process(mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int, structure: int) -> Arx:
    """Fit one of the structures; ``mv`` and ``pv`` about their means, OP and PV units, (n,)."""
    return process_of(fit_processes(mv.reshape(-1, 1), pv, delay, structure), 0, delay)


@kernel
def fit_processes(
    mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int, structure: int
) -> NDArray[np.float64]:
    """Fit one of the structures behind each valve, a column of ``mv`` (n, k); see ``least_squares``."""
    if structure == INTEGRATOR:
        return fit_integrator(mv, pv, delay)
    if structure == FIRST_ORDER:
        return fit_first_order(mv, pv, delay)
    return fit_second_order(mv, pv, delay)


@kernel
def process_of(coefficients: NDArray[np.float64], i: int, delay: int) -> Arx:
    """Return the process in column ``i`` of what ``least_squares`` returns."""
    c = coefficients[:, i]
    return Arx(c[0], c[1], c[2], c[3], c[4], delay)


@kernel
def plausible(process: Arx, gain_sign: int) -> bool:
    """Whether the process is physically plausible.

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
def mean_squared_errors(
    coefficients: NDArray[np.float64], mv: NDArray[np.float64], pv: NDArray[np.float64], delay: int
) -> NDArray[np.float64]:
    """Return the mean squared free-run error of each process, PV units squared, shape (k,).

    Each runs as ``simulate_arx`` has it, all in step, and no model is kept. Infinite where model and PV are
    both known in too few samples.

    Args:
        coefficients: a1, a2, b1, b2 and bias of the processes, shape (5, k).
        mv: Valve positions, OP units, shape (n, k).
        pv: Process variable, PV units, shape (n,).
        delay: Of all processes, samples.
    """
    k = mv.shape[1]
    if delay >= pv.size:
        return np.full(k, np.inf)
    a1, a2, b1, b2, bias = coefficients[0], coefficients[1], coefficients[2], coefficients[3], coefficients[4]
    last, before_last = np.full(k, pv[delay]), np.full(k, pv[delay - 1])
    total, rows = np.zeros(k), np.zeros(k)
    for t in range(delay + 1, pv.size):
        x1, x2, measured = mv[t - delay], mv[t - delay - 1], pv[t]
        for i in range(k):
            forced = b1[i] * x1[i] + b2[i] * x2[i]
            y = a1[i] * last[i] + (a2[i] * before_last[i] + forced + bias[i])
            before_last[i] = last[i]
            last[i] = measured if np.isnan(y) else y
            difference = measured - y
            known = not np.isnan(difference)
            total[i] += difference * difference if known else 0.0
            rows[i] += 1.0 if known else 0.0
    return np.where(rows >= FEWEST_ROWS, total / rows, np.inf)


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
    count = bands.shape[0]
    errors = np.full((count, delays.size), np.inf)
    mv = np.zeros((op.size, min(count, SIDE_BY_SIDE)))
    for start in range(0, count, SIDE_BY_SIDE):
        together = min(SIDE_BY_SIDE, count - start)
        for i in range(together):
            # Columns left over in the last round keep older valves, which nobody reads.
            mv[:, i] = valve_position(op, bands[start + i, 0], bands[start + i, 1], law)
        for j in range(delays.size):
            fitted = fit_processes(mv, pv, delays[j], structure)
            possible = [i for i in range(together) if plausible(process_of(fitted, i, delays[j]), gain_sign)]
            if possible:
                mean_squared = mean_squared_errors(fitted, mv, pv, delays[j])
                for i in possible:
                    errors[start + i, j] = mean_squared[i]
    return errors
