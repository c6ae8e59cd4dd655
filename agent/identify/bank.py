"""A bank of first-order processes, for scoring a valve with the best of them in closed form.

With c(t) the sum from t on of PV filtered backward by the adjoint of high pass and process, the covariance of
PV with a delayed response is the sum over the valve's moves of move * c(t + delay): a score (``bank_score``)
costs little more than the valve itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray
from agent.identify.problem import STROKE_TIME, Problem, first_blocks
from agent.jit import kernel

GROUP = 16
"""Processes that a score takes side by side: four times as many numbers as fit into one register. A bank has
a multiple of it, filled up with processes that do not answer."""


class Bank(NamedTuple):
    """One record before many processes; gaps count as no deviation here, for this only orders candidates."""

    op: FloatArray
    """Native OP, OP units, (n,)."""
    block: int
    keep: float
    """Pole of the high-pass filter, per block."""
    poles: FloatArray
    """Per block; 1 is an integrator, (k,)."""
    second: FloatArray
    """Second poles, 0 where there is none, (k,)."""
    gains: FloatArray
    """What makes each gain one (the integrator: one per sample), (k,)."""
    sums: FloatArray
    """c(t) of the module's text, PV units, (m + longest delay + 2, k)."""
    burn: int
    """First block that counts."""
    gram: FloatArray
    """Inverse Gram matrix of level and end of the filter's memory, (2, 2)."""
    squares: float
    """Sum of squares of PV, PV units squared."""
    early: int
    """Samples in which a valve that slips first slips: until the loop has swung once and a half."""
    gain_sign: int


def bank(problem: Problem, taus: FloatArray, ratios: FloatArray, periods: float) -> Bank:
    """Return the bank of the first ``periods`` periods.

    ``taus`` in samples, infinite for an integrator; ``ratios`` of the second time constant to the first, of
    an integrator to a quarter period; both (k,).
    """
    block = problem.block
    m = first_blocks(problem, periods, 200)
    counted = np.flatnonzero(problem.weight[:m] > 0)
    burn = int(counted[0]) if len(counted) else 0
    at = np.arange(m)
    basis = np.stack([np.ones(m), problem.keep**at], axis=1)
    basis[:burn] = 0.0
    gram = np.linalg.pinv(basis.T @ basis)
    pv = problem.pv[:m] - basis @ (gram @ (basis.T @ problem.pv[:m]))
    poles = np.exp(-block / taus)
    gains = np.where(np.isinf(taus), float(block), 1.0 - poles)
    taus2 = ratios * np.where(np.isinf(taus), problem.period / 4, taus)
    second = np.exp(-block / np.maximum(taus2, 1e-3))
    gains *= 1.0 - second
    missing = -len(taus) % GROUP
    poles, second, gains = (np.pad(each, (0, missing)) for each in (poles, second, gains))
    longest = int(problem.max_delay / block) + 4
    sums = np.zeros((m + longest, len(poles)))
    backward_sums(adjoint_high_pass(pv, problem.keep), poles, second, gains, sums)
    return Bank(
        op=np.ascontiguousarray(problem.op[: m * block]),
        block=block,
        keep=problem.keep,
        poles=poles,
        second=second,
        gains=gains,
        sums=sums,
        burn=burn,
        gram=gram,
        squares=float(pv @ pv),
        early=problem.quiet + int(STROKE_TIME * problem.period),
        gain_sign=problem.gain_sign,
    )


@kernel
def adjoint_high_pass(signal: FloatArray, keep: float) -> FloatArray:
    """Return the transpose of ``high_pass`` applied to the signal, (m,)."""
    m = signal.size
    passed = np.zeros(m)
    ahead = 0.0
    for t in range(m - 1, 0, -1):
        ahead = keep * (ahead + signal[t])
        passed[t] += ahead
        passed[t - 1] -= ahead
    return passed


@kernel
def backward_sums(
    signal: FloatArray, poles: FloatArray, second: FloatArray, gains: FloatArray, sums: FloatArray
) -> None:
    """Fill c(t), the sum from t on of the signal filtered backward in time by each process, (m, k)."""
    for i in range(poles.size):
        filtered = 0.0
        twice = 0.0
        total = 0.0
        for t in range(signal.size - 1, -1, -1):
            filtered = poles[i] * filtered + gains[i] * signal[t]
            twice = second[i] * twice + filtered
            total += twice
            sums[t, i] = total
