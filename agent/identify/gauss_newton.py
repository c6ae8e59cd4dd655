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
from agent.identify.objective import AT_ONCE, DELAY, INTEGRATOR, LEAST_LOG_TAU, LOG_TAU, LOG_TAU2, SOPDT
from agent.identify.problem import Problem
from agent.identify.process_columns import (
    BY_DELAY,
    BY_POLE,
    BY_POLE2,
    COLUMNS,
    NUISANCE_FROM,
    PV,
    RESPONSE,
    START_UP,
    Passes,
    Processes,
    fill_products,
    fill_products_of_response,
    passes_for,
    poles_of,
    product,
)
from agent.jit import kernel
from agent.lanes import (
    WIDTH,
    Lanes,
    Mask,
    Rows,
    all_lanes,
    any_of,
    exp,
    larger,
    load,
    no_lane,
    smaller,
    splat,
    store,
    where,
)

SEEN = 1e-6
"""Share of a column that must remain beside nuisance and other columns: rounding has less than a hundredth of
it, and at 1e-9 a lone early slip, whose response lies in the nuisance space, ended at an error of zero."""
START_UP_SEEN = 1e-4
"""Likewise for the start-up, which is never much different from nuisance where the lag is long."""
RIDGE = 1e-4
"""Relative damping of a step, after Levenberg and Marquardt: more than the curvature that is neglected of a
process near its optimum, less than what a step from afar needs."""
LONGEST = (0.8, 1.0, 2.0)
"""Longest step in log tau, log tau2 and delay (blocks): the model is linear over about as much."""
SHORTER = 0.4
"""Factor by which a step shrinks that did not lower the error."""
CONVERGED = 1e-4
"""Relative gain of a step after which no other is tried."""
HOPE = 0.7
"""Share of the error that a Gauss-Newton step predicts which a process may reach at best by further steps."""


RIGHT = COLUMNS
"""Place of the right-hand side, and then of the solution, in a row of the normal equations."""
ROW = COLUMNS + 1
TAU, DEAD, TAU2, KIND, GIVE_UP, ERROR = range(6)
"""Rows of ``values``: log tau, delay (samples), log tau2, structure, and (PV units squared) the error above
which a fit is of no interest and the one found."""
VALUES = 6


class ProcessFits(NamedTuple):
    """Room for the fits of the processes of a group to one record."""

    passes: Passes
    normal: Rows
    """The normal equations less their projection on the nuisance, (COLUMNS * ROW, ``WIDTH``)."""
    values: Rows
    """Of the candidates, on their way to lanes and back, (``VALUES``, ``WIDTH``)."""


class ProcessStep(NamedTuple):
    """Errors of processes behind their paths, and the steps to better ones."""

    error: Lanes
    """Sum of squares, PV units squared."""
    predicted: Lanes
    """Of the linearised model after the step."""
    log_tau: Lanes
    delay: Lanes
    """samples"""
    log_tau2: Lanes


@kernel
def fits_for(problem: Problem) -> ProcessFits:
    """Return room for a record."""
    return ProcessFits(passes_for(problem), np.empty((COLUMNS * ROW, WIDTH)), np.empty((VALUES, WIDTH)))


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
    give_up, squares = load(fits.values, GIVE_UP), np.dot(problem.pv, problem.pv)
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
        step = steps_of(tried, problem, squares, fits)
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
) -> Processes:
    """Return the processes of the candidates at some places; the last one has all lanes that remain."""
    values = fits.values
    for lane in range(WIDTH):
        i = places[min(lane, places.size - 1)]
        values[TAU, lane], values[DEAD, lane] = candidates[i, LOG_TAU], candidates[i, DELAY]
        values[TAU2, lane], values[KIND, lane] = candidates[i, LOG_TAU2], structures[i]
    kind = load(values, KIND)
    lags, second = kind != float(INTEGRATOR), kind == float(SOPDT)
    return Processes(load(values, TAU), load(values, DEAD), load(values, TAU2), lags, second)


@kernel
def write_back(
    best: Processes, error: Lanes, candidates: FloatArray, places: IntArray, fits: ProcessFits
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
def chosen(mask: Mask, one: Processes, other: Processes) -> Processes:
    """Return ``one`` where the mask is true, ``other`` elsewhere; both have the same structures."""
    return Processes(
        where(mask, one.log_tau, other.log_tau),
        where(mask, one.delay, other.delay),
        where(mask, one.log_tau2, other.log_tau2),
        one.lags,
        one.second,
    )


@kernel
def within_bounds(
    processes: Processes, log_tau: Lanes, delay: Lanes, log_tau2: Lanes, problem: Problem
) -> Processes:
    """Return processes moved by a step, within bounds."""
    tau = smaller(larger(processes.log_tau + log_tau, LEAST_LOG_TAU), problem.max_log_tau)
    tau2 = smaller(larger(processes.log_tau2 + log_tau2, LEAST_LOG_TAU), tau)
    moved = smaller(larger(processes.delay + delay, 1.0), problem.max_delay)
    if problem.fixed_delay > 0.0:
        moved = splat(problem.fixed_delay)
    return Processes(tau, moved, tau2, processes.lags, processes.second)


@kernel
def least_errors(
    processes: Processes, problem: Problem, squares: float, room: Passes
) -> tuple[Lanes, Lanes, Mask]:
    """Return the least sums of squares of response, start-up and nuisance, the gains, and which start up.

    The gain is 0 where the response has no gain of the right sign, or is not seen beside the nuisance.
    """
    sign = float(problem.gain_sign)
    all_of_it, with_pv = product(room, RESPONSE, RESPONSE), product(room, RESPONSE, PV)
    response = beside_nuisance(room, RESPONSE, RESPONSE)
    seen = (response > SEEN * all_of_it) & (all_of_it > 0.0)
    start_up, both = beside_nuisance(room, START_UP, START_UP), beside_nuisance(room, RESPONSE, START_UP)
    starts_pv = product(room, START_UP, PV)
    determinant = response * start_up - both * both
    starts = (
        seen
        & processes.lags
        & (start_up > START_UP_SEEN * product(room, START_UP, START_UP))
        & (determinant > SEEN * response * start_up)
    )
    gain = where(starts, (with_pv * start_up - starts_pv * both) / determinant, with_pv / response)
    level = where(starts, (starts_pv * response - with_pv * both) / determinant, 0.0)
    right = seen & (gain * sign >= 0.0)
    alone = where(starts, squares - starts_pv * starts_pv / start_up, squares)
    error = where(right, larger(0.0, squares - gain * with_pv - level * starts_pv), alone)
    return error, where(right, gain, 0.0), starts


@kernel
def beside_nuisance(room: Passes, i: int, j: int) -> Lanes:
    """Return the product of two columns less that of their projections on the nuisance."""
    one, two, three = NUISANCE_FROM, NUISANCE_FROM + 1, NUISANCE_FROM + 2
    projected = product(room, i, one) * product(room, j, one)
    projected = projected + product(room, i, two) * product(room, j, two)
    projected = projected + product(room, i, three) * product(room, j, three)
    return product(room, i, j) - projected


@kernel
def steps_of(processes: Processes, problem: Problem, squares: float, fits: ProcessFits) -> ProcessStep:
    """Return the exact errors of processes and the steps to better ones, from ``fits.passes.products``."""
    room, block = fits.passes, problem.block
    error, gain, starts = least_errors(processes, problem, squares, room)
    pole, pole2 = poles_of(processes, block)
    by_pole2 = processes.second & (pole2 > 1e-4)
    by_delay = no_lane() if problem.fixed_delay > 0.0 else all_lanes()
    fill_normal(room, fits.normal, (all_lanes(), processes.lags, by_pole2, by_delay, starts))
    scale, predicted = solve(fits.normal, squares)
    goes = (gain != 0.0) & (scale * gain > 0.0)
    per_tau = larger(pole * block / exp(processes.log_tau), 1e-12)
    per_tau2 = larger(pole2 * block / exp(larger(processes.log_tau2, AT_ONCE)), 1e-12)
    by_tau, by_tau2 = solved(fits, BY_POLE) / scale / per_tau, solved(fits, BY_POLE2) / scale / per_tau2
    by_delay_blocks = solved(fits, BY_DELAY) / scale
    return ProcessStep(
        error,
        where(goes, larger(0.0, smaller(predicted, error)), error),
        where(goes & processes.lags, clipped(by_tau, LONGEST[0]), 0.0),
        where(goes & by_delay, clipped(by_delay_blocks, LONGEST[2]) * block, 0.0),
        where(goes & by_pole2, clipped(by_tau2, LONGEST[1]), 0.0),
    )


@kernel
def clipped(lanes: Lanes, most: float) -> Lanes:
    """Return the numbers within +-``most``."""
    return smaller(most, larger(-most, lanes))


@kernel
def solved(fits: ProcessFits, column: int) -> Lanes:
    """Return the solution for a column."""
    return load(fits.normal, ROW * column + RIGHT)


@kernel
def fill_normal(room: Passes, normal: Rows, used: tuple[Mask, Mask, Mask, Mask, Mask]) -> None:
    """Fill the normal equations of the columns that are used; of the others the solution is zero.

    Derivatives are damped.
    """
    for i, may in enumerate(used):
        square = beside_nuisance(room, i, i)
        ridge = RIDGE if 0 < i < START_UP else 1e-9
        uses = may & (square > 0.0)
        store(normal, ROW * i + i, where(uses, square * (1.0 + ridge), 1.0))
        store(normal, ROW * i + RIGHT, where(uses, product(room, i, PV), 0.0))
        for j, may_too in enumerate(used):
            if j > i:
                both_used = uses & may_too & (beside_nuisance(room, j, j) > 0.0)
                both = where(both_used, beside_nuisance(room, i, j), 0.0)
                store(normal, ROW * i + j, both)
                store(normal, ROW * j + i, both)


@kernel
def solve(normal: Rows, squares: float) -> tuple[Lanes, Lanes]:
    """Solve the normal equations in place; return the gains, and the errors that the solution leaves."""
    left = splat(squares)
    right = (
        load(normal, RIGHT),
        load(normal, ROW + RIGHT),
        load(normal, 2 * ROW + RIGHT),
        load(normal, 3 * ROW + RIGHT),
        load(normal, 4 * ROW + RIGHT),
    )
    singular = left < 0.0
    for i in range(COLUMNS):
        pivot = load(normal, ROW * i + i)
        singular = singular | ((pivot < 1e-300) & (pivot > -1e-300))
        inverse = 1.0 / pivot
        for r in range(COLUMNS):
            if r != i:
                share = load(normal, ROW * r + i) * inverse
                for j in range(i, ROW):
                    changed = load(normal, ROW * r + j) - share * load(normal, ROW * i + j)
                    store(normal, ROW * r + j, changed)
    for i, before in enumerate(right):
        solution = load(normal, ROW * i + RIGHT) / load(normal, ROW * i + i)
        store(normal, ROW * i + RIGHT, solution)
        left = left - solution * before
    return load(normal, RIGHT), where(singular, squares, left)
