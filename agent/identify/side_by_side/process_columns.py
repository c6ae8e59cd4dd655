"""The columns of the least-squares problem of a process behind a valve's path, and their products.

Response to gain one, its derivatives by both poles and by the delay (the same recursions, differentiated),
and the start-up; all behind the high-pass filter of the record. For the candidates of a group side by side,
each with its own path, poles and delay.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from agent.identify.arrays import IntArray
from agent.identify.objective import AT_ONCE, nuisance_rows
from agent.identify.problem import NUISANCE, Problem, to_blocks
from agent.jit import kernel
from agent.lanes import (
    WIDTH,
    Lanes,
    Mask,
    Rows,
    exp,
    fused,
    larger,
    load,
    most_of,
    smaller,
    splat,
    store,
    where,
)

RESPONSE, BY_POLE, BY_POLE2, BY_DELAY, START_UP, PV, NUISANCE_FROM = range(7)
"""Columns, and what they are multiplied with; the nuisance has the last places."""
COLUMNS = 5
PLACES = NUISANCE_FROM + NUISANCE
AT_EACH_BLOCK = 4
"""Columns that are kept block by block; the start-up is a power of the pole."""
FADED, LOOKS = 1e-8, 16
"""Start-up below this no longer matters; it is looked at every so many blocks."""
LEAST_EXPONENT = -700.0
"""Of a pole; it is zero from there on."""


class ProcessLanes(NamedTuple):
    """Processes of a group, one a lane."""

    log_tau: Lanes
    """log of samples"""
    delay: Lanes
    """samples"""
    log_tau2: Lanes
    """log of samples"""
    lags: Mask
    """All but integrators; only these start up."""
    second: Mask
    """Those with a second lag."""


class Passes(NamedTuple):
    """Room for passes over one record with the processes of a group."""

    lag: Rows
    """Delay, blocks, (1, ``WIDTH``);"""
    whole: IntArray
    """as whole ones, (``WIDTH``,)."""
    delayed: Rows
    """The path, high-passed but for a factor, as many blocks later, OP units, (m, ``WIDTH``)."""
    columns: Rows
    """``AT_EACH_BLOCK`` rows for each block, (m * AT_EACH_BLOCK, ``WIDTH``)."""
    products: Rows
    """Sums of products: of each column with itself, the columns after it, PV and the nuisance, ``PLACES``
    rows for each, (COLUMNS * PLACES, ``WIDTH``)."""


@kernel
def passes_for(problem: Problem) -> Passes:
    """Return room for a record."""
    m = problem.pv.size
    return Passes(
        np.empty((1, WIDTH)),
        np.empty(WIDTH, np.int64),
        np.empty((m, WIDTH)),
        np.empty((AT_EACH_BLOCK * m, WIDTH)),
        np.zeros((COLUMNS * PLACES, WIDTH)),
    )


@kernel
def poles_of(processes: ProcessLanes, block: int) -> tuple[Lanes, Lanes]:
    """Return both poles a block; 1 for an integrator, 0 where there is no second lag."""
    tau2 = exp(larger(smaller(processes.log_tau2, processes.log_tau), AT_ONCE))
    pole = exp(larger(-block / exp(processes.log_tau), LEAST_EXPONENT))
    pole2 = exp(larger(-block / tau2, LEAST_EXPONENT))
    return where(processes.lags, pole, 1.0), where(processes.second, pole2, 0.0)


@kernel
def delay_paths(processes: ProcessLanes, passed: Rows, problem: Problem, room: Passes) -> Lanes:
    """Fill ``delayed`` from the high-passed paths (m, ``WIDTH``); return the delays beyond whole blocks."""
    m, whole, delayed = len(passed), room.whole, room.delayed
    lag = to_blocks(processes.delay, problem.block)
    store(room.lag, 0, lag)
    most = 0
    for lane in range(WIDTH):
        whole[lane] = min(int(room.lag[0, lane]), m - 2)
        most = max(most, whole[lane])
        room.lag[0, lane] -= whole[lane]
    for b in range(most):
        store(delayed, b, splat(0.0))
    for b in range(m - most):
        for lane in range(WIDTH):
            delayed[b + whole[lane], lane] = passed[b, lane]
    for b in range(m - most, m):
        for lane in range(WIDTH):
            if b + whole[lane] < m:
                delayed[b + whole[lane], lane] = passed[b, lane]
    return load(room.lag, 0)


@kernel
def fill_products(processes: ProcessLanes, passed: Rows, problem: Problem, room: Passes) -> None:
    """Fill the products of all columns of the processes behind the high-passed paths (m, ``WIDTH``)."""
    part = delay_paths(processes, passed, problem, room)
    pole, pole2 = poles_of(processes, problem.block)
    fill_columns(pole, pole2, part, problem, room)
    products_of_columns(problem, room)
    products_with_nuisance(problem, room)
    products_of_start_up(pole, processes.lags, problem, room)


@kernel
def fill_products_of_response(processes: ProcessLanes, passed: Rows, problem: Problem, room: Passes) -> None:
    """Fill those products only which the error needs: of the response and of the start-up."""
    part = delay_paths(processes, passed, problem, room)
    pole, pole2 = poles_of(processes, problem.block)
    fill_response(pole, pole2, part, problem, room)
    products_of_start_up(pole, processes.lags, problem, room)


@kernel
def fill_columns(pole: Lanes, pole2: Lanes, part: Lanes, problem: Problem, room: Passes) -> None:
    """Fill response, its derivatives by the poles and by the delay, zero where the record does not count."""
    here = 1.0 - part
    first = second = by_first = by_pole = by_pole2 = splat(0.0)
    for t in range(problem.pv.size):
        older, older_by, older_by2 = second, by_pole, by_pole2
        by_first = fused(pole, by_first, first)
        first = fused(pole, first, load(room.delayed, t))
        by_pole = fused(pole2, by_pole, by_first)
        by_pole2 = fused(pole2, by_pole2, second)
        second = fused(pole2, second, first)
        counts, at = problem.weight[t], AT_EACH_BLOCK * t
        store(room.columns, at + RESPONSE, fused(here, second, part * older) * counts)
        store(room.columns, at + BY_POLE, fused(here, by_pole, part * older_by) * counts)
        store(room.columns, at + BY_POLE2, fused(here, by_pole2, part * older_by2) * counts)
        store(room.columns, at + BY_DELAY, (older - second) * counts)


@kernel
def columns_at(t: int, room: Passes) -> tuple[Lanes, Lanes, Lanes, Lanes]:
    """Return the columns at a block."""
    at = AT_EACH_BLOCK * t
    return (
        load(room.columns, at + RESPONSE),
        load(room.columns, at + BY_POLE),
        load(room.columns, at + BY_POLE2),
        load(room.columns, at + BY_DELAY),
    )


@kernel
def products_of_columns(problem: Problem, room: Passes) -> None:
    """Fill the products of the columns with each other and with PV."""
    a00 = a01 = a02 = a03 = a11 = a12 = a13 = a22 = a23 = a33 = splat(0.0)
    y0 = y1 = y2 = y3 = splat(0.0)
    for t in range(problem.pv.size):
        c0, c1, c2, c3 = columns_at(t, room)
        y = problem.pv[t]
        a00, a01, a02, a03 = fused(c0, c0, a00), fused(c0, c1, a01), fused(c0, c2, a02), fused(c0, c3, a03)
        a11, a12, a13 = fused(c1, c1, a11), fused(c1, c2, a12), fused(c1, c3, a13)
        a22, a23, a33 = fused(c2, c2, a22), fused(c2, c3, a23), fused(c3, c3, a33)
        y0, y1, y2, y3 = fused(c0, y, y0), fused(c1, y, y1), fused(c2, y, y2), fused(c3, y, y3)
    keep(room, RESPONSE, RESPONSE, (a00, a01, a02, a03))
    keep(room, BY_POLE, BY_POLE, (a11, a12, a13))
    keep(room, BY_POLE2, BY_POLE2, (a22, a23))
    keep(room, BY_DELAY, BY_DELAY, (a33,))
    for column, with_pv in enumerate((y0, y1, y2, y3)):
        keep(room, column, PV, (with_pv,))


@kernel
def products_with_nuisance(problem: Problem, room: Passes) -> None:
    """Fill the products of the columns with the nuisance."""
    level, slope, memory = nuisance_rows(problem, 0)
    b00 = b01 = b02 = b10 = b11 = b12 = b20 = b21 = b22 = b30 = b31 = b32 = splat(0.0)
    for t in range(problem.pv.size):
        c0, c1, c2, c3 = columns_at(t, room)
        e0, e1, e2 = level[t], slope[t], memory[t]
        b00, b01, b02 = fused(c0, e0, b00), fused(c0, e1, b01), fused(c0, e2, b02)
        b10, b11, b12 = fused(c1, e0, b10), fused(c1, e1, b11), fused(c1, e2, b12)
        b20, b21, b22 = fused(c2, e0, b20), fused(c2, e1, b21), fused(c2, e2, b22)
        b30, b31, b32 = fused(c3, e0, b30), fused(c3, e1, b31), fused(c3, e2, b32)
    keep(room, RESPONSE, NUISANCE_FROM, (b00, b01, b02))
    keep(room, BY_POLE, NUISANCE_FROM, (b10, b11, b12))
    keep(room, BY_POLE2, NUISANCE_FROM, (b20, b21, b22))
    keep(room, BY_DELAY, NUISANCE_FROM, (b30, b31, b32))


@kernel
def fill_response(pole: Lanes, pole2: Lanes, part: Lanes, problem: Problem, room: Passes) -> None:
    """Fill the response and its products with itself, with PV and with the nuisance."""
    here = 1.0 - part
    level, slope, memory = nuisance_rows(problem, 0)
    first = second = square = with_pv = b0 = b1 = b2 = splat(0.0)
    for t in range(problem.pv.size):
        older = second
        first = fused(pole, first, load(room.delayed, t))
        second = fused(pole2, second, first)
        c = fused(here, second, part * older) * problem.weight[t]
        store(room.columns, AT_EACH_BLOCK * t + RESPONSE, c)
        square, with_pv = fused(c, c, square), fused(c, problem.pv[t], with_pv)
        b0, b1, b2 = fused(c, level[t], b0), fused(c, slope[t], b1), fused(c, memory[t], b2)
    keep(room, RESPONSE, RESPONSE, (square,))
    keep(room, RESPONSE, PV, (with_pv, b0, b1, b2))


@kernel
def products_of_start_up(pole: Lanes, lags: Mask, problem: Problem, room: Passes) -> None:
    """Fill the products of the start-up with the columns, with itself, with PV and with the nuisance."""
    level, slope, memory = nuisance_rows(problem, 0)
    u = where(lags, splat(1.0), 0.0)
    p0 = p1 = p2 = p3 = uu = uy = u0 = u1 = u2 = splat(0.0)
    for t in range(problem.pv.size):
        if t % LOOKS == 0:
            u = where(u < FADED, 0.0, u)
            if most_of(u) == 0.0:
                break
        c0, c1, c2, c3 = columns_at(t, room)
        v = u * problem.weight[t]
        p0, p1, p2, p3 = fused(v, c0, p0), fused(v, c1, p1), fused(v, c2, p2), fused(v, c3, p3)
        uu, uy = fused(v, v, uu), fused(v, problem.pv[t], uy)
        u0, u1, u2 = fused(v, level[t], u0), fused(v, slope[t], u1), fused(v, memory[t], u2)
        u = u * pole
    for column, with_start_up in enumerate((p0, p1, p2, p3)):
        keep(room, column, START_UP, (with_start_up,))
    keep(room, START_UP, START_UP, (uu, uy, u0, u1, u2))


@kernel
def keep(room: Passes, column: int, other: int, sums: tuple[Lanes, ...]) -> None:
    """Write the products of a column with the ``other`` one and those after it."""
    for k, each in enumerate(sums):
        store(room.products, PLACES * column + other + k, each)


@kernel
def product(room: Passes, column: int, other: int) -> Lanes:
    """Return the sum of the products of a column with another at its place or later, PV, or the nuisance."""
    return load(room.products, PLACES * column + other)
