"""The process that a valve's path implies: one pass gives the exact error and a Gauss-Newton step.

Behind a known path of the stem, the response s to gain one is known, and so are its derivatives by both poles
and by the delay: the same recursions, differentiated. With start-up and nuisance they are the columns of a
least-squares problem whose normal equations need one pass. The first column alone (with the start-up) gives
the exact error at the process as it stands; all of them the step to a better one (variable projection in
Kaufman's approximation, BIT 15 (1975) 49: the derivatives are multiplied by the gain just solved for).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray
from agent.identify.objective import (
    AT_ONCE,
    DELAY,
    INTEGRATOR,
    LEAST_LOG_TAU,
    LOG_TAU,
    LOG_TAU2,
    SOPDT,
)
from agent.identify.problem import Problem, to_blocks
from agent.identify.process_columns import (
    PV,
    START_UP,
    Passes,
    delayed_products,
    fill_response,
    fill_ways,
    poles_of,
    response_products,
    start_up_and_response,
    start_up_products,
)
from agent.jit import kernel

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


class ProcessStep(NamedTuple):
    """Error of a process behind a path, and the step to a better one."""

    error: float
    """Sum of squares, PV units squared."""
    predicted: float
    """Of the linearised model after the step."""
    log_tau: float
    log_tau2: float
    delay: float
    """samples"""


@kernel
def step_from(
    candidate: FloatArray, structure: int, problem: Problem, squares: float, room: Passes
) -> ProcessStep:
    """Return the exact error of a candidate's process behind ``room.passed``, and the step to a better one.

    Args:
        candidate: Within bounds.
        structure: Of its process.
        problem: The record.
        squares: Sum of squares of PV, PV units squared.
        room: With the path in ``passed``.
    """
    block = problem.block
    pole, pole2 = poles_of(candidate, structure, block)
    fill_ways(room.passed, pole, pole2, room.ways)
    whole, part = delay_of(candidate, problem)
    g, a = room.products, room.normal
    delayed_products(room.ways, whole, part, problem, g)
    lags = structure != INTEGRATOR
    if lags:
        start_up_products(room.ways, whole, part, problem, g)
    for i in range(5):
        for j in range(i, 5):
            a[i, j] = a[j, i] = beside_nuisance(g, i, j) if lags or j < START_UP else 0.0
        a[i, PV] = g[i, PV] if lags or i < START_UP else 0.0
    error, gain, starts = least_error(g, structure, problem.gain_sign, squares)
    if gain == 0.0:
        return ProcessStep(error, error, 0.0, 0.0, 0.0)
    used = (
        True,
        lags,
        structure == SOPDT and pole2 > 1e-4,
        problem.fixed_delay == 0.0,
        starts,
    )
    predicted = solve(a, used, squares)
    scale = a[0, PV]
    if scale * gain <= 0.0:
        return ProcessStep(error, error, 0.0, 0.0, 0.0)
    tau, tau2 = math.exp(candidate[LOG_TAU]), math.exp(max(AT_ONCE, candidate[LOG_TAU2]))
    by_tau = clipped(a[1, PV] / scale / max(pole * block / tau, 1e-12), LONGEST[0]) if used[1] else 0.0
    by_tau2 = clipped(a[2, PV] / scale / max(pole2 * block / tau2, 1e-12), LONGEST[1]) if used[2] else 0.0
    by_delay = clipped(a[3, PV] / scale, LONGEST[2]) * block if used[3] else 0.0
    return ProcessStep(error, max(0.0, min(predicted, error)), by_tau, by_tau2, by_delay)


@kernel
def error_at(candidate: FloatArray, structure: int, problem: Problem, squares: float, room: Passes) -> float:
    """Return the error of ``step_from`` alone, in a third of the time: the last pass needs no step."""
    pole, pole2 = poles_of(candidate, structure, problem.block)
    fill_response(room.passed, pole, pole2, room.ways)
    whole, part = delay_of(candidate, problem)
    response_products(room.ways, whole, part, problem, room.products)
    if structure != INTEGRATOR:
        start_up_and_response(room.ways, whole, part, problem, room.products)
    return float(least_error(room.products, structure, problem.gain_sign, squares)[0])


@kernel
def delay_of(candidate: FloatArray, problem: Problem) -> tuple[int, float]:
    """Return the delay of a candidate: whole blocks, and the part of one that is left."""
    lag = to_blocks(candidate[DELAY], problem.block)
    whole = min(int(lag), problem.pv.size - 2)
    return whole, lag - whole


@kernel
def beside_nuisance(g: FloatArray, i: int, j: int) -> float:
    """Return the product of two columns less that of their projections on the nuisance."""
    return float(g[i, j] - (g[i, 6] * g[j, 6] + g[i, 7] * g[j, 7] + g[i, 8] * g[j, 8]))


@kernel
def least_error(
    g: FloatArray,
    structure: int,
    gain_sign: int,
    squares: float,
) -> tuple[float, float, bool]:
    """Return the least sum of squares of response, start-up and nuisance, the gain, and whether it starts up.

    The gain is 0 where the response has no gain of the right sign, or is not seen beside the nuisance.
    """
    response = beside_nuisance(g, 0, 0)
    if response <= SEEN * g[0, 0] or g[0, 0] == 0.0:
        return squares, 0.0, False
    if structure != INTEGRATOR:
        start_up, both = beside_nuisance(g, START_UP, START_UP), beside_nuisance(g, 0, START_UP)
        determinant = response * start_up - both**2
        if start_up > START_UP_SEEN * g[START_UP, START_UP] and determinant > SEEN * response * start_up:
            gain = (g[0, PV] * start_up - g[START_UP, PV] * both) / determinant
            level = (g[START_UP, PV] * response - g[0, PV] * both) / determinant
            if gain * gain_sign < 0.0:
                return squares - g[START_UP, PV] ** 2 / start_up, 0.0, True
            return max(0.0, squares - gain * g[0, PV] - level * g[START_UP, PV]), gain, True
    gain = g[0, PV] / response
    if gain * gain_sign < 0.0:
        return squares, 0.0, False
    return max(0.0, squares - gain * g[0, PV]), gain, False


@kernel
def clipped(value: float, most: float) -> float:
    """Return the value within +-``most``."""
    return min(most, max(-most, value))


@kernel
def solve(a: FloatArray, used: tuple[bool, bool, bool, bool, bool], squares: float) -> float:
    """Solve the normal equations (5, 6) in place for the columns used; return the error that they leave.

    The solution stands in the last column. Derivatives are damped.
    """
    right = (a[0, PV], a[1, PV], a[2, PV], a[3, PV], a[4, PV])
    for i in range(5):
        if not used[i] or a[i, i] <= 0.0:
            for j in range(5):
                a[i, j] = a[j, i] = 0.0
            a[i, i], a[i, PV] = 1.0, 0.0
        else:
            a[i, i] *= 1.0 + (RIDGE if 0 < i < START_UP else 1e-9)
    for i in range(5):
        pivot = a[i, i]
        if abs(pivot) < 1e-300:
            return squares
        for r in range(5):
            share = a[r, i] / pivot
            if r != i and share != 0.0:
                for j in range(i, 6):
                    a[r, j] -= share * a[i, j]
    left = squares
    for i in range(5):
        a[i, PV] /= a[i, i]
        left -= a[i, PV] * right[i]
    return left


@kernel
def fit_process(
    candidate: FloatArray,
    structure: int,
    problem: Problem,
    squares: float,
    evaluations: int,
    room: Passes,
    give_up: float = np.inf,
) -> float:
    """Improve a candidate's process in place behind the path in ``room.passed``; return its error.

    Args:
        candidate: Within bounds; its valve stays.
        structure: Of its process.
        problem: The record.
        squares: Sum of squares of PV, PV units squared.
        evaluations: Passes over the record, at most.
        room: With the path in ``passed``.
        give_up: Error above which it is of no interest; where even a further step cannot get below, it ends.
    """
    step = step_from(candidate, structure, problem, squares, room)
    best = step.error
    if step.log_tau == 0.0 and step.log_tau2 == 0.0 and step.delay == 0.0:
        return best
    if HOPE * step.predicted > give_up:
        return best
    tau, tau2, delay = candidate[LOG_TAU], candidate[LOG_TAU2], candidate[DELAY]
    share = 1.0
    for further in range(evaluations - 1, 0, -1):
        candidate[LOG_TAU] = min(max(tau + share * step.log_tau, LEAST_LOG_TAU), problem.max_log_tau)
        candidate[LOG_TAU2] = min(max(tau2 + share * step.log_tau2, LEAST_LOG_TAU), candidate[LOG_TAU])
        candidate[DELAY] = min(max(delay + share * step.delay, 1.0), problem.max_delay)
        if problem.fixed_delay > 0.0:
            candidate[DELAY] = problem.fixed_delay
        if further == 1:
            error = error_at(candidate, structure, problem, squares, room)
            if error < best:
                return error
            break
        tried = step_from(candidate, structure, problem, squares, room)
        if tried.error < best:
            gained = best - tried.error
            best, step = tried.error, tried
            tau, tau2, delay = candidate[LOG_TAU], candidate[LOG_TAU2], candidate[DELAY]
            share = 1.0
            if gained < CONVERGED * best or HOPE * step.predicted > give_up:
                break
        else:
            share *= SHORTER
    candidate[LOG_TAU], candidate[LOG_TAU2], candidate[DELAY] = tau, tau2, delay
    return best
