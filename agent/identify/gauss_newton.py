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
    block_mean,
)
from agent.identify.problem import Problem, to_blocks
from agent.jit import fused_kernel, kernel, summing_kernel

RESPONSE, BY_POLE, BY_POLE2, BY_DELAY, START_UP, PV = range(6)
"""Columns of the least-squares problem."""
SEEN = 1e-6
"""Share of a column that must remain beside nuisance and other columns: rounding has less than a hundredth of
it, and at 1e-9 a lone early slip, whose response lies in the nuisance space, ended at an error of zero."""
START_UP_SEEN = 1e-4
"""Likewise for the start-up, which is never much different from nuisance where the lag is long."""
FADED = 1e-8
"""Start-up below this no longer matters."""
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


class Step(NamedTuple):
    """Error of a process behind a path, and the step to a better one."""

    error: float
    """Sum of squares, PV units squared."""
    predicted: float
    """Of the linearised model after the step."""
    log_tau: float
    log_tau2: float
    delay: float
    """samples"""


class Room(NamedTuple):
    """Room for the passes over one record, so that candidates share it."""

    passed: FloatArray
    """Block means of the path, high-passed but for a factor, OP units, (m,)."""
    ways: FloatArray
    """Response, its derivatives by the poles, start-up; without delay, (4, m)."""
    products: FloatArray
    """Sums of products of the columns, (6, 6), and with the nuisance, (6, 3) behind it: (6, 9)."""
    normal: FloatArray
    """The normal equations less their projection on the nuisance, with the right-hand side, (5, 6)."""


@kernel
def room_for(problem: Problem) -> Room:
    """Return room for a record."""
    m = problem.pv.size
    return Room(np.empty(m), np.empty((4, m)), np.zeros((6, 9)), np.zeros((5, 6)))


@kernel
def poles_of(candidate: FloatArray, structure: int, block: int) -> tuple[float, float]:
    """Return both poles a block; 1 for an integrator, 0 where there is no second lag."""
    if structure == INTEGRATOR:
        return 1.0, 0.0
    pole2 = 0.0
    if structure == SOPDT:
        pole2 = math.exp(-block / math.exp(max(AT_ONCE, min(candidate[LOG_TAU2], candidate[LOG_TAU]))))
    return math.exp(-block / math.exp(candidate[LOG_TAU])), pole2


@fused_kernel
def pass_high(position: FloatArray, problem: Problem, passed: FloatArray) -> None:
    """Fill ``passed`` with the block means of the position behind the high pass, but for its factor."""
    former, high = block_mean(position, 0, problem.block), 0.0
    for b in range(passed.size):
        mean = block_mean(position, b, problem.block)
        high = problem.keep * high + (mean - former)
        former = mean
        passed[b] = high


@fused_kernel
def fill_ways(passed: FloatArray, pole: float, pole2: float, ways: FloatArray) -> None:
    """Fill the response of gain one, its derivatives by both poles, and the start-up."""
    first = second = by_first = by_pole = by_pole2 = 0.0
    start_up = 1.0
    for b in range(passed.size):
        by_first = pole * by_first + first
        first = pole * first + passed[b]
        by_pole = pole2 * by_pole + by_first
        by_pole2 = pole2 * by_pole2 + second
        second = pole2 * second + first
        ways[0, b], ways[1, b], ways[2, b], ways[3, b] = second, by_pole, by_pole2, start_up
        start_up *= pole


@summing_kernel
def delayed_products(  # noqa: PLR0915 - one sum a line, so that each stays in a register
    ways: FloatArray, whole: int, part: float, problem: Problem, g: FloatArray
) -> None:
    """Fill the products of the delayed columns with each other, with PV and with the nuisance."""
    z, q1, q2 = ways[0], ways[1], ways[2]
    pv, weight, basis = problem.pv, problem.weight, problem.basis
    a00 = a01 = a02 = a03 = a11 = a12 = a13 = a22 = a23 = a33 = 0.0
    y0 = y1 = y2 = y3 = 0.0
    here = 1.0 - part
    begin = whole + 1
    for t in range(begin, pv.size):
        k = weight[t]
        c0 = (here * z[t - whole] + part * z[t - begin]) * k
        c1 = (here * q1[t - whole] + part * q1[t - begin]) * k
        c2 = (here * q2[t - whole] + part * q2[t - begin]) * k
        c3 = (z[t - begin] - z[t - whole]) * k
        a00 += c0 * c0
        a01 += c0 * c1
        a02 += c0 * c2
        a03 += c0 * c3
        a11 += c1 * c1
        a12 += c1 * c2
        a13 += c1 * c3
        a22 += c2 * c2
        a23 += c2 * c3
        a33 += c3 * c3
        y = pv[t]
        y0 += c0 * y
        y1 += c1 * y
        y2 += c2 * y
        y3 += c3 * y
    g[0, 0], g[0, 1], g[0, 2], g[0, 3] = a00, a01, a02, a03
    g[1, 1], g[1, 2], g[1, 3], g[2, 2], g[2, 3], g[3, 3] = a11, a12, a13, a22, a23, a33
    g[0, PV], g[1, PV], g[2, PV], g[3, PV] = y0, y1, y2, y3
    b00 = b01 = b02 = b10 = b11 = b12 = b20 = b21 = b22 = b30 = b31 = b32 = 0.0
    # A second loop: the sums of the first fill the registers.
    for t in range(begin, pv.size):
        k = weight[t]
        c0 = (here * z[t - whole] + part * z[t - begin]) * k
        c1 = (here * q1[t - whole] + part * q1[t - begin]) * k
        c2 = (here * q2[t - whole] + part * q2[t - begin]) * k
        c3 = (z[t - begin] - z[t - whole]) * k
        e0, e1, e2 = basis[t, 0], basis[t, 1], basis[t, 2]
        b00 += c0 * e0
        b01 += c0 * e1
        b02 += c0 * e2
        b10 += c1 * e0
        b11 += c1 * e1
        b12 += c1 * e2
        b20 += c2 * e0
        b21 += c2 * e1
        b22 += c2 * e2
        b30 += c3 * e0
        b31 += c3 * e1
        b32 += c3 * e2
    g[0, 6], g[0, 7], g[0, 8] = b00, b01, b02
    g[1, 6], g[1, 7], g[1, 8] = b10, b11, b12
    g[2, 6], g[2, 7], g[2, 8] = b20, b21, b22
    g[3, 6], g[3, 7], g[3, 8] = b30, b31, b32


@summing_kernel
def start_up_products(ways: FloatArray, whole: int, part: float, problem: Problem, g: FloatArray) -> None:
    """Fill the products of the start-up with all columns, with PV and with the nuisance."""
    z, q1, q2, u = ways[0], ways[1], ways[2], ways[3]
    pv, weight, basis = problem.pv, problem.weight, problem.basis
    end = faded(u)
    uu = uy = u0 = u1 = u2 = 0.0
    for t in range(end):
        v = u[t] * weight[t]
        uu += v * v
        uy += v * pv[t]
        u0 += v * basis[t, 0]
        u1 += v * basis[t, 1]
        u2 += v * basis[t, 2]
    c0 = c1 = c2 = c3 = 0.0
    here = 1.0 - part
    begin = whole + 1
    for t in range(begin, end):
        v = u[t] * weight[t]
        c0 += v * (here * z[t - whole] + part * z[t - begin])
        c1 += v * (here * q1[t - whole] + part * q1[t - begin])
        c2 += v * (here * q2[t - whole] + part * q2[t - begin])
        c3 += v * (z[t - begin] - z[t - whole])
    g[0, START_UP], g[1, START_UP], g[2, START_UP], g[3, START_UP] = c0, c1, c2, c3
    g[START_UP, START_UP], g[START_UP, PV] = uu, uy
    g[START_UP, 6], g[START_UP, 7], g[START_UP, 8] = u0, u1, u2


@kernel
def faded(start_up: FloatArray) -> int:
    """Return the block from which a start-up, which falls, no longer matters."""
    low, high = 0, start_up.size
    while low < high:
        middle = (low + high) // 2
        if start_up[middle] < FADED:
            high = middle
        else:
            low = middle + 1
    return low


@kernel
def step_from(candidate: FloatArray, structure: int, problem: Problem, squares: float, room: Room) -> Step:
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
    lag = to_blocks(candidate[DELAY], block)
    whole = min(int(lag), problem.pv.size - 2)
    part = lag - whole
    g, a = room.products, room.normal
    delayed_products(room.ways, whole, part, problem, g)
    lags = structure != INTEGRATOR
    if lags:
        start_up_products(room.ways, whole, part, problem, g)
    for i in range(5):
        for j in range(i, 5):
            product = g[i, j] if lags or j < START_UP else 0.0
            if lags or j < START_UP:
                product -= g[i, 6] * g[j, 6] + g[i, 7] * g[j, 7] + g[i, 8] * g[j, 8]
            a[i, j] = a[j, i] = product
        a[i, PV] = g[i, PV] if lags or i < START_UP else 0.0
    if a[0, 0] <= SEEN * g[0, 0] or g[0, 0] == 0.0:
        return Step(squares, squares, 0.0, 0.0, 0.0)
    determinant = a[0, 0] * a[4, 4] - a[0, 4] ** 2
    starts = lags and a[4, 4] > START_UP_SEEN * g[4, 4] and determinant > SEEN * a[0, 0] * a[4, 4]
    if starts:
        gain = (a[0, PV] * a[4, 4] - a[4, PV] * a[0, 4]) / determinant
        level = (a[4, PV] * a[0, 0] - a[0, PV] * a[0, 4]) / determinant
        if gain * problem.gain_sign < 0.0:
            alone = squares - a[4, PV] ** 2 / a[4, 4]
            return Step(alone, alone, 0.0, 0.0, 0.0)
        error = squares - gain * a[0, PV] - level * a[4, PV]
    else:
        gain = a[0, PV] / a[0, 0]
        if gain * problem.gain_sign < 0.0:
            return Step(squares, squares, 0.0, 0.0, 0.0)
        error = squares - gain * a[0, PV]
    error = max(0.0, error)
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
        return Step(error, error, 0.0, 0.0, 0.0)
    tau, tau2 = math.exp(candidate[LOG_TAU]), math.exp(max(AT_ONCE, candidate[LOG_TAU2]))
    by_tau = clipped(a[1, PV] / scale / max(pole * block / tau, 1e-12), LONGEST[0]) if used[1] else 0.0
    by_tau2 = clipped(a[2, PV] / scale / max(pole2 * block / tau2, 1e-12), LONGEST[1]) if used[2] else 0.0
    by_delay = clipped(a[3, PV] / scale, LONGEST[2]) * block if used[3] else 0.0
    return Step(error, max(0.0, min(predicted, error)), by_tau, by_tau2, by_delay)


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
    room: Room,
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
    for _ in range(evaluations - 1):
        candidate[LOG_TAU] = min(max(tau + share * step.log_tau, LEAST_LOG_TAU), problem.max_log_tau)
        candidate[LOG_TAU2] = min(max(tau2 + share * step.log_tau2, LEAST_LOG_TAU), candidate[LOG_TAU])
        candidate[DELAY] = min(max(delay + share * step.delay, 1.0), problem.max_delay)
        if problem.fixed_delay > 0.0:
            candidate[DELAY] = problem.fixed_delay
        tried = step_from(candidate, structure, problem, squares, room)
        if tried.error < best:
            gained = best - tried.error
            best, step = tried.error, tried
            tau, tau2, delay = candidate[LOG_TAU], candidate[LOG_TAU2], candidate[DELAY]
            share = 1.0
            if gained < CONVERGED * best:
                break
        else:
            share *= SHORTER
    candidate[LOG_TAU], candidate[LOG_TAU2], candidate[DELAY] = tau, tau2, delay
    return best
