"""One candidate: its valve, its process, and gain, level, slope and start-up solved in closed form.

Variable projection: PV = gain * process(valve(OP)) + basis * coefficients + start-up * exp(-t / tau) is
linear in gain, coefficients and start-up, so only the rest is searched (design, fact 4).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray
from agent.identify.problem import NUISANCE, OVER, Problem, along_column, to_blocks
from agent.jit import fused_kernel, inlined_kernel, kernel, summing_kernel
from agent.physics.valves.damped_stem import DAMPING, GIVE, REST, SUPPLY, damped_stem

# Structures of the process.
FOPDT, SOPDT, INTEGRATOR = 0, 1, 2
# Coordinates of a candidate, shape (11,).
LOG_TAU, DELAY, LOG_TAU2, S, J_RATIO, LEVEL, LOG_DAMPING, LOG_SUPPLY, LOG_REST, FIRST, BRISTLES = range(11)
# log(tau) and log(tau2) in samples; delay in samples, >= 1; S in OP units, 0: no stiction; J/S; level: OP
# at the first slip, OP units, and first: its direction, 1 or -1, so that the stem before it rests at level
# - first f_S and S or J may change without moving that slip; logs of damping (samples), supply (samples)
# and rest of the stem; what its bristles give, 0: they are stiff.
SIZE = 11

IMPOSSIBLE = np.inf
LEAST_LOG_TAU = math.log(0.2)
AT_ONCE = -5.0
"""Log of a second time constant (samples) below which it makes no difference, and exp would end at 0."""
RIGID = -9.0
"""Log of rest below which a stem stays as it is: He's valve."""
STEM_LOW = (math.log(DAMPING[0]), math.log(SUPPLY[0]), math.log(REST[0]))
STEM_HIGH = (math.log(DAMPING[1]), math.log(SUPPLY[1]), math.log(REST[1]))
"""Bounds of damping, supply and rest of every other stem."""


class Valve(NamedTuple):
    """What ``damped_stem`` takes beside OP."""

    f_s: float
    f_d: float
    x0: float
    damping: float
    supply: float
    rest: float
    give: float


@kernel
def valve_of(candidate: FloatArray) -> Valve:
    """Return the valve of a candidate that sticks."""
    f_s = candidate[S] * (1.0 + candidate[J_RATIO]) / 2.0
    return Valve(
        f_s,
        candidate[S] * (1.0 - candidate[J_RATIO]) / 2.0,
        candidate[LEVEL] - candidate[FIRST] * f_s,
        math.exp(candidate[LOG_DAMPING]),
        math.exp(candidate[LOG_SUPPLY]),
        math.exp(candidate[LOG_REST]),
        candidate[BRISTLES],
    )


@kernel
def stem_of(valve: Valve, op: FloatArray) -> FloatArray:
    """Return the stem position that ``op`` (n,) causes, OP units, (n,)."""
    return damped_stem(
        op, valve.f_s, valve.f_d, valve.x0, valve.damping, valve.supply, valve.rest, valve.give
    )


@kernel
def valve_position(candidate: FloatArray, problem: Problem) -> FloatArray:
    """Return the stem position of a candidate's valve, OP units, (n,)."""
    if candidate[S] == 0.0:
        return problem.op
    return stem_of(valve_of(candidate), problem.op)


class Process(NamedTuple):
    """High pass, process of gain one and delay, in blocks.

    Its filters have no gains of their own, so that each waits for one product and sum a block.
    """

    pole: float
    pole2: float
    keep: float
    """Pole of the high-pass filter."""
    block: int
    """Samples in a block."""
    whole: int
    """Blocks of the delay; the fraction that is left is interpolated,"""
    now: float
    """with the gain of all filters times the part of this block,"""
    then: float
    """and that of the block before."""


@kernel
def process_of(candidate: FloatArray, structure: int, block: int, keep: float, m: int) -> Process:
    """Return the process of a candidate for a record of ``m`` blocks."""
    pole = 1.0
    in_gain = 1.0 * block
    if structure != INTEGRATOR:
        pole = math.exp(-block / math.exp(candidate[LOG_TAU]))
        in_gain = 1.0 - pole
    pole2 = 0.0
    if structure == SOPDT:
        pole2 = math.exp(-block / math.exp(max(AT_ONCE, min(candidate[LOG_TAU2], candidate[LOG_TAU]))))
    # A block of PV lies (block - 1) / 2 samples after its first, a block's response at its end.
    lag = to_blocks(candidate[DELAY], block)
    gain = in_gain * (1.0 - pole2) * keep
    then = gain * (lag - int(lag))
    return Process(pole, pole2, keep, block, min(int(lag), m), gain - then, then)


class Memory(NamedTuple):
    """Where the filters stand; no array, for it would be read before it is written, at every shot."""

    passed: float
    """Position high-passed."""
    former: float
    """Mean of the block before."""
    first: float
    second: float
    """Both lags; like ``passed`` less their gains."""


@inlined_kernel
def block_mean(position: FloatArray, b: int, block: int) -> float:
    """Return the mean of one block of the position (n,)."""
    mean = position[b]
    if block > 1:
        mean = 0.0
        for t in range(b * block, (b + 1) * block):
            mean += position[t]
        mean /= block
    return float(mean)


@kernel
def at_rest(position: FloatArray, block: int) -> Memory:
    """Return the memory of a process in balance with the first block of the position (n,)."""
    return Memory(0.0, block_mean(position, 0, block), 0.0, 0.0)


@fused_kernel
def respond(
    position: FloatArray, begin: int, end: int, process: Process, memory: Memory, response: FloatArray
) -> Memory:
    """Add to the response (m,) what the blocks ``begin`` to ``end`` of the position (n,) cause; OP units.

    ``memory`` is of the blocks before; that of the last one is returned. y(t) depends first on
    position(t - delay). One loop for all filters, so that the processor works on them side by side.
    """
    block, keep, pole, pole2 = process.block, process.keep, process.pole, process.pole2
    whole, now, then = process.whole, process.now, process.then
    passed, former, first, second = memory
    for b in range(begin, min(end, response.size - whole)):
        mean = block_mean(position, b, block)
        passed = keep * passed + (mean - former)
        former = mean
        first = pole * first + passed
        older = second
        second = pole2 * second + first
        response[b + whole] = now * second + then * older
    return Memory(passed, former, first, second)


@kernel
def process_response(
    position: FloatArray, candidate: FloatArray, structure: int, block: int, keep: float
) -> FloatArray:
    """Return the high-passed response of gain one in blocks to the valve position, OP units, (m,)."""
    m = position.size // block
    process = process_of(candidate, structure, block, keep, m)
    response = np.empty(m)
    response[: process.whole] = 0.0
    respond(position, 0, m, process, at_rest(position, block), response)
    return response


@kernel
def nuisance_rows(problem: Problem, begin: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the columns of the nuisance from a block on, each contiguous also for the compiler."""
    rows = problem.basis.T
    return rows[0, begin:], rows[1, begin:], rows[2, begin:]


@summing_kernel
def fit_gain(
    response: FloatArray, candidate: FloatArray, structure: int, problem: Problem
) -> tuple[float, float, float]:
    """Return the least sum of squares (PV units squared), the gain and the start-up coefficient."""
    m = response.size
    startup_pole = 0.0 if structure == INTEGRATOR else math.exp(-problem.block / math.exp(candidate[LOG_TAU]))
    r0 = r1 = r2 = s0 = s1 = s2 = 0.0
    yy = rr = ss = rs = ry = sy = 0.0
    level, slope, memory = nuisance_rows(problem, 0)
    startup = 0.0 if structure == INTEGRATOR else 1.0
    for t in range(m):
        y = problem.pv[t]
        r = response[t] * problem.weight[t]
        yy += y * y
        rr += r * r
        ry += r * y
        r0 += level[t] * r
        r1 += slope[t] * r
        r2 += memory[t] * r
    for t in range(m):
        if startup < OVER:
            break
        if problem.weight[t] > 0.0:
            ss += startup * startup
            rs += response[t] * startup
            sy += startup * problem.pv[t]
            s0 += level[t] * startup
            s1 += slope[t] * startup
            s2 += memory[t] * startup
        startup *= startup_pole
    raw = rr
    rr -= r0 * r0 + r1 * r1 + r2 * r2
    rs -= r0 * s0 + r1 * s1 + r2 * s2
    ss_left = ss - (s0 * s0 + s1 * s1 + s2 * s2)
    for k in range(NUISANCE, problem.basis.shape[1]):
        along, along_startup = along_column(problem.basis.T[k], response, startup_pole)
        rr -= along * along
        rs -= along * along_startup
        ss_left -= along_startup * along_startup
    if rr <= 1e-9 * raw:
        return yy, 0.0, 0.0
    determinant = rr * ss_left - rs * rs
    if ss_left > 1e-4 * ss and determinant > 1e-9 * rr * ss_left:
        gain = (ry * ss_left - sy * rs) / determinant
        if gain * problem.gain_sign >= 0.0:
            coefficient = (sy * rr - ry * rs) / determinant
            return yy - gain * ry - coefficient * sy, gain, coefficient
        return yy - sy * sy / ss_left, 0.0, sy / ss_left
    gain = ry / rr
    if gain * problem.gain_sign < 0.0:
        return yy, 0.0, 0.0
    return yy - gain * ry, gain, 0.0


@kernel
def stem_in_bounds(candidate: FloatArray) -> bool:
    """Whether damping, supply, rest and bristles are those of a stem that takes its time."""
    for axis in range(3):
        if not STEM_LOW[axis] <= candidate[LOG_DAMPING + axis] <= STEM_HIGH[axis]:
            return False
    return bool(candidate[BRISTLES] == 0.0 or GIVE[0] <= candidate[BRISTLES] <= GIVE[1])


@kernel
def in_bounds(candidate: FloatArray, problem: Problem) -> bool:
    """Whether every coordinate is one that a valve and a process may have."""
    if not 1.0 <= candidate[DELAY] <= problem.max_delay + 1.0:
        return False
    if not LEAST_LOG_TAU <= candidate[LOG_TAU] <= problem.max_log_tau:
        return False
    if not 0.0 <= candidate[S] <= problem.op_span:
        return False
    if not (0.0 <= candidate[J_RATIO] <= 1.0):
        return False
    return bool(candidate[S] == 0.0 or candidate[LOG_REST] <= RIGID or stem_in_bounds(candidate))
