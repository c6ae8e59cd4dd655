"""The record behind filters that make the noise of a wandering load white, each for another noise.

A walk with white noise on top of it is an integrated moving average: differences of the series are
e(t) - keep e(t-1) (Box and Jenkins, Time Series Analysis, 1970, ch. 4). So the innovations e are the series
behind the high pass (1 - q) / (1 - keep q). keep near 1: white noise on a level; near 0: a walk.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.problem import FINE
from agent.identify.problem import bridge, high_pass, nuisance_basis
from agent.physics.processes.decimation import block_means

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.identify.problem import Problem

MEMORIES = (0.4, 2.0, 15.0)
"""Time constants of the filters, blocks. One more is as long as the record: it takes a slow drift off."""
LONGEST = 1 / 3
"""Of the other time constants, over the record."""


def noise_models(window: LoopWindow, problem: Problem) -> list[Problem]:
    """Return the problem behind each filter, in fine blocks, the quickest noise first."""
    block = max(1, len(window) // FINE)
    n = len(window) // block * block
    counts = np.zeros(len(window))
    counts[: len(problem.weight) * problem.block] = np.repeat(problem.weight, problem.block)
    weight = (block_means(counts[:n], block) == 1.0).astype(np.float64)
    pv = block_means(bridge(window.pv)[:n], block)
    fine = problem._replace(block=block, weight=weight, op=problem.op[:n])
    memories = [each for each in MEMORIES if each < LONGEST * len(pv)]
    return [_filtered(pv, fine, memory) for memory in (*memories, float(len(pv)))]


def _filtered(pv: np.ndarray[tuple[int], np.dtype[np.float64]], problem: Problem, memory: float) -> Problem:
    """Return the problem with innovations of unit gain for PV."""
    keep = math.exp(-1 / memory)
    passed = high_pass(pv - pv[problem.weight > 0].mean(), keep) / keep
    basis = nuisance_basis(problem.weight, keep)
    passed = (passed - basis @ (basis.T @ (passed * problem.weight))) * problem.weight
    return problem._replace(keep=keep, pv=passed, basis=basis)
