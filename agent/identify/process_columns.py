"""The columns of the least-squares problem of a process behind a valve's path, and their products.

Response to gain one, its derivatives by both poles and by the delay (the same recursions, differentiated),
and the start-up; all behind the high-pass filter of the record.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray
from agent.identify.objective import AT_ONCE, INTEGRATOR, LOG_TAU, LOG_TAU2, SOPDT, block_mean, nuisance_rows
from agent.identify.problem import Problem
from agent.jit import fused_kernel, kernel, summing_kernel

START_UP, PV = 4, 5
"""Columns after response, its derivatives by both poles, and by the delay."""
FADED = 1e-8
"""Start-up below this no longer matters."""


class Passes(NamedTuple):
    """Passes for the passes over one record, so that candidates share it."""

    passed: FloatArray
    """Block means of the path, high-passed but for a factor, OP units, (m,)."""
    ways: FloatArray
    """Response, its derivatives by the poles, start-up; without delay, (4, m)."""
    products: FloatArray
    """Sums of products of the columns, (6, 6), and with the nuisance, (6, 3) behind it: (6, 9)."""
    normal: FloatArray
    """The normal equations less their projection on the nuisance, with the right-hand side, (5, 6)."""


@kernel
def passes_for(problem: Problem) -> Passes:
    """Return room for a record."""
    m = problem.pv.size
    return Passes(np.empty(m), np.empty((4, m)), np.zeros((6, 9)), np.zeros((5, 6)))


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


@fused_kernel
def fill_response(passed: FloatArray, pole: float, pole2: float, ways: FloatArray) -> None:
    """Fill the response of gain one and the start-up alone."""
    first = second = 0.0
    start_up = 1.0
    for b in range(passed.size):
        first = pole * first + passed[b]
        second = pole2 * second + first
        ways[0, b], ways[3, b] = second, start_up
        start_up *= pole


@summing_kernel
def delayed_products(  # noqa: PLR0915 - one sum a line, so that each stays in a register
    ways: FloatArray, whole: int, part: float, problem: Problem, g: FloatArray
) -> None:
    """Fill the products of the delayed columns with each other, with PV and with the nuisance.

    Each array is cut to where the columns are known, for an index that might be negative keeps the compiler
    from taking several samples at once.
    """
    begin = whole + 1
    n = problem.pv.size - begin
    z, q1, q2 = ways[0, 1 : n + 1], ways[1, 1 : n + 1], ways[2, 1 : n + 1]
    older_z, older_q1, older_q2 = ways[0, :n], ways[1, :n], ways[2, :n]
    pv, weight = problem.pv[begin:], problem.weight[begin:]
    a00 = a01 = a02 = a03 = a11 = a12 = a13 = a22 = a23 = a33 = 0.0
    y0 = y1 = y2 = y3 = 0.0
    here = 1.0 - part
    for t in range(n):
        k = weight[t]
        c0 = (here * z[t] + part * older_z[t]) * k
        c1 = (here * q1[t] + part * older_q1[t]) * k
        c2 = (here * q2[t] + part * older_q2[t]) * k
        c3 = (older_z[t] - z[t]) * k
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
    level, slope, memory = nuisance_rows(problem, begin)
    for t in range(n):
        k = weight[t]
        c0 = (here * z[t] + part * older_z[t]) * k
        c1 = (here * q1[t] + part * older_q1[t]) * k
        c2 = (here * q2[t] + part * older_q2[t]) * k
        c3 = (older_z[t] - z[t]) * k
        e0, e1, e2 = level[t], slope[t], memory[t]
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
def response_products(ways: FloatArray, whole: int, part: float, problem: Problem, g: FloatArray) -> None:
    """Fill the products of the delayed response alone with itself, with PV and with the nuisance."""
    begin = whole + 1
    n = problem.pv.size - begin
    z, older = ways[0, 1 : n + 1], ways[0, :n]
    pv, weight = problem.pv[begin:], problem.weight[begin:]
    level, slope, memory = nuisance_rows(problem, begin)
    here = 1.0 - part
    square = with_pv = b0 = b1 = b2 = 0.0
    for t in range(n):
        c = (here * z[t] + part * older[t]) * weight[t]
        square += c * c
        with_pv += c * pv[t]
        b0 += c * level[t]
        b1 += c * slope[t]
        b2 += c * memory[t]
    g[0, 0], g[0, PV], g[0, 6], g[0, 7], g[0, 8] = square, with_pv, b0, b1, b2


@summing_kernel
def start_up_products(ways: FloatArray, whole: int, part: float, problem: Problem, g: FloatArray) -> None:
    """Fill the products of the start-up with all columns, with PV and with the nuisance."""
    z, q1, q2 = ways[0], ways[1], ways[2]
    c0 = c1 = c2 = c3 = 0.0
    here = 1.0 - part
    begin = whole + 1
    u, weight = ways[3], problem.weight
    for t in range(begin, faded(u)):
        v = u[t] * weight[t]
        c0 += v * (here * z[t - whole] + part * z[t - begin])
        c1 += v * (here * q1[t - whole] + part * q1[t - begin])
        c2 += v * (here * q2[t - whole] + part * q2[t - begin])
        c3 += v * (z[t - begin] - z[t - whole])
    g[0, START_UP], g[1, START_UP], g[2, START_UP], g[3, START_UP] = c0, c1, c2, c3
    start_up_alone(ways, problem, g)


@summing_kernel
def start_up_and_response(ways: FloatArray, whole: int, part: float, problem: Problem, g: FloatArray) -> None:
    """Fill the products of the start-up with the response, with itself, with PV and with the nuisance."""
    u, weight, z = ways[3], problem.weight, ways[0]
    here, begin = 1.0 - part, whole + 1
    product = 0.0
    for t in range(begin, faded(u)):
        product += u[t] * weight[t] * (here * z[t - whole] + part * z[t - begin])
    g[0, START_UP] = product
    start_up_alone(ways, problem, g)


@summing_kernel
def start_up_alone(ways: FloatArray, problem: Problem, g: FloatArray) -> None:
    """Fill the products of the start-up with itself, with PV and with the nuisance."""
    u, pv, weight = ways[3], problem.pv, problem.weight
    level, slope, memory = nuisance_rows(problem, 0)
    uu = uy = u0 = u1 = u2 = 0.0
    for t in range(faded(u)):
        v = u[t] * weight[t]
        uu += v * v
        uy += v * pv[t]
        u0 += v * level[t]
        u1 += v * slope[t]
        u2 += v * memory[t]
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
