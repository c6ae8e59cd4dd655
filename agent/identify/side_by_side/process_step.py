"""The least error of a process behind a valve's path, and the Gauss-Newton step to a better one.

Both in closed form, from the sums of products of the columns (``process_columns``): response and start-up
beside the nuisance give the error; with the derivatives, the step.
"""

from __future__ import annotations

from typing import NamedTuple

from agent.identify.objective import AT_ONCE
from agent.identify.problem import Problem
from agent.identify.side_by_side.process_columns import (
    BY_DELAY,
    BY_POLE,
    BY_POLE2,
    COLUMNS,
    NUISANCE_FROM,
    PV,
    RESPONSE,
    START_UP,
    Passes,
    ProcessLanes,
    poles_of,
    product,
)
from agent.jit import kernel
from agent.lanes import Lanes, Mask, Rows, all_lanes, exp, larger, load, no_lane, smaller, splat, store, where

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
SINGULAR = 1e-300
"""Pivot, PV or OP units squared, below which the equations have no solution."""
RIGHT = COLUMNS
"""Place of the right-hand side, and then of the solution, in a row of the normal equations."""
ROW = COLUMNS + 1


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
def least_errors(
    processes: ProcessLanes, problem: Problem, squares: float, room: Passes
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
def steps_of(
    processes: ProcessLanes, problem: Problem, squares: float, room: Passes, normal: Rows
) -> ProcessStep:
    """Return the exact errors of processes and the steps to better ones, from ``room.products``."""
    block = problem.block
    error, gain, starts = least_errors(processes, problem, squares, room)
    pole, pole2 = poles_of(processes, block)
    by_pole2 = processes.second & (pole2 > 1e-4)
    by_delay = no_lane() if problem.fixed_delay > 0.0 else all_lanes()
    fill_normal(room, normal, (all_lanes(), processes.lags, by_pole2, by_delay, starts))
    scale, predicted = solve(normal, squares)
    goes = (gain != 0.0) & (scale * gain > 0.0)
    per_tau = larger(pole * block / exp(processes.log_tau), 1e-12)
    per_tau2 = larger(pole2 * block / exp(larger(processes.log_tau2, AT_ONCE)), 1e-12)
    by_tau, by_tau2 = solved(normal, BY_POLE) / scale / per_tau, solved(normal, BY_POLE2) / scale / per_tau2
    by_delay_blocks = solved(normal, BY_DELAY) / scale
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
def solved(normal: Rows, column: int) -> Lanes:
    """Return the solution for a column."""
    return load(normal, ROW * column + RIGHT)


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
    singular = no_lane()
    for i in range(COLUMNS):
        pivot = load(normal, ROW * i + i)
        singular = singular | ((pivot < SINGULAR) & (pivot > -SINGULAR))
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
