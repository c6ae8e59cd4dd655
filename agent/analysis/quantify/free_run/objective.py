"""Free-run error of one candidate, with gain, level, drift and start-up solved in closed form.

Variable projection: PV = gain * process(valve(OP)) + basis * coefficients + start-up * exp(-t / tau) is
linear in gain, coefficients and start-up, so only the rest is searched (design, fact 4).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.problem import Problem
from agent.jit import kernel
from agent.physics.valves.damped_stem import damped_stem

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray

# Structures of the process.
FOPDT, SOPDT, INTEGRATOR = 0, 1, 2
# Coordinates of a candidate, shape (8,).
LOG_TAU, DELAY, LOG_TAU2, S, J_RATIO, START, LAG, REST = range(8)
# log(tau) and log(tau2) in samples; delay in samples, >= 1; S in OP units, 0: no stiction; J/S;
# start: force on the stem before the first sample over f_S, -1 to 1; lag; rest over the OP span, 1: always.
SIZE = 8

IMPOSSIBLE = np.inf
LEAST_LOG_TAU = math.log(0.2)


@kernel
def process_response(position: FloatArray, candidate: FloatArray, structure: int) -> FloatArray:
    """Return the response of gain one to the valve, OP units, (n,); it starts in rest at position(0).

    y(t) depends first on position(t - delay); a fraction of a sample is interpolated.
    """
    n = position.size
    pole = 0.0 if structure == INTEGRATOR else math.exp(-1.0 / math.exp(candidate[LOG_TAU]))
    pole2 = 0.0
    if structure == SOPDT:
        pole2 = math.exp(-1.0 / math.exp(min(candidate[LOG_TAU2], candidate[LOG_TAU])))
    mean = 0.0
    for t in range(n):
        mean += position[t] / n
    start = 0.0 if structure == INTEGRATOR else position[0] - mean
    undelayed = np.empty(n)
    first = start
    second = start
    for t in range(n):
        undelayed[t] = second
        if structure == INTEGRATOR:
            first += position[t] - mean
        else:
            first = pole * first + (1.0 - pole) * (position[t] - mean)
        second = pole2 * second + (1.0 - pole2) * first
    lag = candidate[DELAY] - 1.0
    whole = int(lag)
    part = lag - whole
    response = np.empty(n)
    for t in range(n):
        newer = undelayed[t - whole] if t >= whole else start
        older = undelayed[t - whole - 1] if t > whole else start
        response[t] = (1.0 - part) * newer + part * older
    return response


@kernel
def fit_gain(
    response: FloatArray, candidate: FloatArray, structure: int, problem: Problem
) -> tuple[float, float, float]:
    """Return the least sum of squares (PV units squared), the gain and the start-up coefficient."""
    n, m = problem.basis.shape
    startup_pole = 0.0 if structure == INTEGRATOR else math.exp(-1.0 / math.exp(candidate[LOG_TAU]))
    on_basis = np.zeros(m)
    startup_on_basis = np.zeros(m)
    yy = rr = ss = rs = ry = sy = 0.0
    startup = 0.0 if structure == INTEGRATOR else 1.0
    for t in range(n):
        if problem.weight[t] > 0.0:
            y = problem.pv[t]
            r = response[t]
            yy += y * y
            rr += r * r
            ss += startup * startup
            rs += r * startup
            ry += r * y
            sy += startup * y
            for j in range(m):
                on_basis[j] += problem.basis[t, j] * r
                startup_on_basis[j] += problem.basis[t, j] * startup
        if t + 1 >= candidate[DELAY]:
            startup *= startup_pole
    raw = rr
    for j in range(m):
        rr -= on_basis[j] * on_basis[j]
        rs -= on_basis[j] * startup_on_basis[j]
        ss -= startup_on_basis[j] * startup_on_basis[j]
    if rr <= 1e-9 * raw:
        return yy, 0.0, 0.0
    determinant = rr * ss - rs * rs
    if ss > 1e-9 and determinant > 1e-9 * rr * ss:
        gain = (ry * ss - sy * rs) / determinant
        if gain * problem.gain_sign >= 0.0:
            coefficient = (sy * rr - ry * rs) / determinant
            return yy - gain * ry - coefficient * sy, gain, coefficient
        return yy - sy * sy / ss, 0.0, sy / ss
    gain = ry / rr
    if gain * problem.gain_sign < 0.0:
        return yy, 0.0, 0.0
    return yy - gain * ry, gain, 0.0


@kernel
def valve_position(candidate: FloatArray, problem: Problem) -> FloatArray:
    """Return the stem position of a candidate's valve, OP units, (n,)."""
    if candidate[S] == 0.0:
        return problem.op
    f_s = candidate[S] * (1.0 + candidate[J_RATIO]) / 2.0
    f_d = candidate[S] * (1.0 - candidate[J_RATIO]) / 2.0
    rest = candidate[REST] * problem.op_span
    return damped_stem(problem.op, f_s, f_d, problem.op[0] - candidate[START] * f_s, candidate[LAG], rest)


@kernel
def free_run_error(candidate: FloatArray, structure: int, problem: Problem) -> float:
    """Return the sum of squares of PV minus its free run, PV units squared; infinite out of bounds."""
    if not 1.0 <= candidate[DELAY] <= problem.max_delay + 1.0:
        return IMPOSSIBLE
    if not LEAST_LOG_TAU <= candidate[LOG_TAU] <= problem.max_log_tau:
        return IMPOSSIBLE
    if not 0.0 <= candidate[S] <= problem.op_span:
        return IMPOSSIBLE
    if not (0.0 <= candidate[J_RATIO] <= 1.0 and -1.0 < candidate[START] < 1.0):
        return IMPOSSIBLE
    if not (0.0 <= candidate[LAG] <= 0.6 and 0.0 <= candidate[REST] <= 1.0):
        return IMPOSSIBLE
    response = process_response(valve_position(candidate, problem), candidate, structure)
    return fit_gain(response, candidate, structure, problem)[0]
