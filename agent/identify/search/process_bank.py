"""Processes and delays on a grid, one of which a valve gets at first sight."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray, IntArray
from agent.identify.objective import FOPDT, INTEGRATOR, LEAST_LOG_TAU, SOPDT
from agent.identify.problem import to_blocks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.problem import Problem

RATIO = 0.6
"""Of the second time constant to the first: between one lag and two equal ones."""
SINGLE = 0.35
"""Share of the delays that are one block apart, from none on; the others are apart by a factor."""
NO_LAG = 2.0
"""Log of the time constant that an integrator carries along, samples; a child with a lag begins near it."""


class Processes(NamedTuple):
    """Processes of a bank, also for kernels; each (k,)."""

    taus: FloatArray
    """samples, infinite for an integrator"""
    ratios: FloatArray
    """Of the second time constant to the first."""
    log_tau: FloatArray
    """samples"""
    log_tau2: FloatArray
    structure: IntArray


def processes_of(problem: Problem, structures: Sequence[int], lags: int) -> Processes:
    """Return the possible processes with ``lags`` time constants from half a block to a period."""
    slowest = max(6.0, problem.period)
    each = np.geomspace(max(0.7, 0.5 * problem.block), slowest, lags)
    taus, ratios, structure = [np.empty(0)], [np.empty(0)], [np.empty(0, dtype=np.int64)]
    for kind, some, ratio in ((FOPDT, each, 0.0), (SOPDT, each, RATIO), (INTEGRATOR, [math.inf], 0.0)):
        if kind in structures:
            taus.append(np.array(some))
            ratios.append(np.full(len(some), ratio))
            structure.append(np.full(len(some), kind, dtype=np.int64))
    tau, of_lag, kinds = np.concatenate(taus), np.concatenate(ratios), np.concatenate(structure)
    log_tau = np.minimum(np.log(np.where(np.isinf(tau), math.exp(NO_LAG), tau)), problem.max_log_tau)
    log_tau2 = np.where(of_lag > 0, log_tau + np.log(np.maximum(of_lag, 1e-3)), LEAST_LOG_TAU)
    return Processes(tau, of_lag, log_tau, np.maximum(log_tau2, LEAST_LOG_TAU), kinds)


def delays_of(problem: Problem, count: int, share: float) -> IntArray:
    """Return about ``count`` delays up to a ``share`` of the longest, ascending, blocks; or the given one."""
    first = 1 if problem.block == 1 else 0
    if problem.fixed_delay > 0:
        return np.array([round(to_blocks(problem.fixed_delay, problem.block))])
    longest = share * problem.max_delay / problem.block
    single = round(SINGLE * count)
    steps = np.concatenate([np.arange(single), np.geomspace(single, max(5.0, longest), count - single)])
    return first + np.unique(np.round(steps).astype(np.int64))
