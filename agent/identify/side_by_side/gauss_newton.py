"""The process that a valve's path implies: one pass gives the exact error and a Gauss-Newton step.

Behind a known path of the stem, the response s to gain one is known, and so are its derivatives by both poles
and by the delay: the same recursions, differentiated. With start-up and nuisance they are the columns of a
least-squares problem whose normal equations need one pass. The first column alone (with the start-up) gives
the exact error at the process as it stands; all of them the step to a better one (variable projection in
Kaufman's approximation, BIT 15 (1975) 49: the derivatives are multiplied by the gain just solved for).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray, IntArray
from agent.identify.objective import DELAY, INTEGRATOR, LEAST_LOG_TAU, LOG_TAU, LOG_TAU2, SOPDT
from agent.identify.problem import Problem
from agent.identify.side_by_side.process_columns import (
    COLUMNS,
    Passes,
    ProcessLanes,
    fill_products,
    fill_products_of_response,
    passes_for,
)
from agent.identify.side_by_side.process_step import ROW, least_errors, steps_of
from agent.jit import kernel
from agent.lanes import (
    WIDTH,
    Lanes,
    Mask,
    Rows,
    all_lanes,
    any_of,
    larger,
    load,
    smaller,
    splat,
    store,
    where,
)

SHORTER = 0.4
"""Factor by which a step shrinks that did not lower the error."""
CONVERGED = 1e-4
"""Relative gain of a step after which no other is tried."""
HOPE = 0.7
"""Share of the error that a Gauss-Newton step predicts which a process may reach at best by further steps."""
TAU, DEAD, TAU2, KIND, GIVE_UP, ERROR = range(6)
"""Rows of ``values``: log tau, delay (samples), log tau2, structure, and (PV units squared) the error above
which a fit is of no interest and the one found."""
VALUES = 6


class ProcessFits(NamedTuple):
    """Room for the fits of the processes of a group to one record."""

    passes: Passes
    squares: float
    """Sum of squares of PV, PV units squared."""
    normal: Rows
    """The normal equations less their projection on the nuisance, (COLUMNS * ROW, ``WIDTH``)."""
    values: Rows
    """Of the candidates, on their way to lanes and back, (``VALUES``, ``WIDTH``)."""


@kernel
def fits_for(problem: Problem) -> ProcessFits:
    """Return room for a record."""
    squares = np.dot(problem.pv, problem.pv)
    normal, values = np.empty((COLUMNS * ROW, WIDTH)), np.empty((VALUES, WIDTH))
    return ProcessFits(passes_for(problem), squares, normal, values)


@kernel
def fit_processes(
    candidates: FloatArray,
    structures: IntArray,
    places: IntArray,
    problem: Problem,
    evaluations: int,
    passed: Rows,
    fits: ProcessFits,
) -> None:
    """Improve the processes of the candidates of a group in place, each behind its path.

    Args:
        candidates: Within bounds; their valves stay, (k, SIZE).
        structures: Of their processes, (k,).
        places: Of the candidates of the group, one to ``WIDTH``.
        problem: The record.
        evaluations: Passes over the record, at most.
        passed: The paths, high-passed but for a factor, OP units, (m, ``WIDTH``).
        fits: ``values[GIVE_UP]`` is given; takes ``values[ERROR]``. A fit ends where it gains little, and
            where even a further step cannot get below ``GIVE_UP``.
    """
    best = processes_at(candidates, structures, places, fits)
    give_up, squares = load(fits.values, GIVE_UP), fits.squares
    goes_on, error, tried = all_lanes(), splat(np.inf), best
    log_tau = delay = log_tau2 = splat(0.0)  # the step
    for evaluation in range(evaluations):
        if 0 < evaluation == evaluations - 1:
            fill_products_of_response(tried, passed, problem, fits.passes)
            now = least_errors(tried, problem, squares, fits.passes)[0]
            better = goes_on & (now < error)
            best, error = chosen(better, tried, best), where(better, now, error)
            break
        fill_products(tried, passed, problem, fits.passes)
        step = steps_of(tried, problem, squares, fits.passes, fits.normal)
        better = goes_on & (step.error < error)
        gains = error - step.error >= CONVERGED * step.error
        best, error = chosen(better, tried, best), where(better, step.error, error)
        log_tau = where(better, step.log_tau, SHORTER * log_tau)
        delay = where(better, step.delay, SHORTER * delay)
        log_tau2 = where(better, step.log_tau2, SHORTER * log_tau2)
        moves = (log_tau != 0.0) | (delay != 0.0) | (log_tau2 != 0.0)
        goes_on = goes_on & (~better | (gains & moves & (HOPE * step.predicted <= give_up)))
        if not any_of(goes_on):
            break
        tried = within_bounds(best, log_tau, delay, log_tau2, problem)
    write_back(best, error, candidates, places, fits)


@kernel
def processes_at(
    candidates: FloatArray, structures: IntArray, places: IntArray, fits: ProcessFits
) -> ProcessLanes:
    """Return the processes of the candidates at some places; the last one has all lanes that remain."""
    values = fits.values
    for lane in range(WIDTH):
        i = places[min(lane, places.size - 1)]
        values[TAU, lane], values[DEAD, lane] = candidates[i, LOG_TAU], candidates[i, DELAY]
        values[TAU2, lane], values[KIND, lane] = candidates[i, LOG_TAU2], structures[i]
    kind = load(values, KIND)
    lags, second = kind != float(INTEGRATOR), kind == float(SOPDT)
    return ProcessLanes(load(values, TAU), load(values, DEAD), load(values, TAU2), lags, second)


@kernel
def write_back(
    best: ProcessLanes, error: Lanes, candidates: FloatArray, places: IntArray, fits: ProcessFits
) -> None:
    """Write processes into their candidates, and their errors into ``values``."""
    values = fits.values
    store(values, TAU, best.log_tau)
    store(values, DEAD, best.delay)
    store(values, TAU2, best.log_tau2)
    store(values, ERROR, error)
    for lane in range(places.size):
        i = places[lane]
        candidates[i, LOG_TAU], candidates[i, DELAY] = values[TAU, lane], values[DEAD, lane]
        candidates[i, LOG_TAU2] = values[TAU2, lane]


@kernel
def chosen(mask: Mask, one: ProcessLanes, other: ProcessLanes) -> ProcessLanes:
    """Return ``one`` where the mask is true, ``other`` elsewhere; both have the same structures."""
    return ProcessLanes(
        where(mask, one.log_tau, other.log_tau),
        where(mask, one.delay, other.delay),
        where(mask, one.log_tau2, other.log_tau2),
        one.lags,
        one.second,
    )


@kernel
def within_bounds(
    processes: ProcessLanes, log_tau: Lanes, delay: Lanes, log_tau2: Lanes, problem: Problem
) -> ProcessLanes:
    """Return processes moved by a step, within bounds."""
    tau = smaller(larger(processes.log_tau + log_tau, LEAST_LOG_TAU), problem.max_log_tau)
    tau2 = smaller(larger(processes.log_tau2 + log_tau2, LEAST_LOG_TAU), tau)
    moved = smaller(larger(processes.delay + delay, 1.0), problem.max_delay)
    if problem.fixed_delay > 0.0:
        moved = splat(problem.fixed_delay)
    return ProcessLanes(tau, moved, tau2, processes.lags, processes.second)
