"""One wave of a load beside a process: what a limit cycle of a sticking valve must beat.

In closed loop a load that oscillates makes OP oscillate as the controller says, and a dead band has the gain
and the phase lag at one frequency that turn that OP into this PV (the condition of a limit cycle). The
difference is that a wave goes on at its frequency whatever the set point does, and has no corners as OP has
them. So the load of the sound model may be a sinusoid with any frequency, amplitude and phase.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import minimize_scalar

from agent.analysis.innovations.process_search import best_process
from agent.analysis.innovations.whitened import Fit, log_likelihood
from agent.identify.residuals import residuals

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray, LoopHints
    from agent.identify.problem import Problem

TURNS = 4
"""Of frequency and process at most: a process that was bent to the wave leaves it at nearly its frequency. Of
simulated loops three settle it."""
SETTLED = 0.01
"""Cycles in the whole record by which a frequency changes that is settled."""
CYCLES = 3.0
"""Of the slowest wave in a record: less is a drift."""
FINER = 4
"""Points of the spectrum for each of its lines: the highest is then within 3 % of the line's power."""
NUMBERS = 3
"""Frequency, amplitude and phase: each costs half the logarithm of the samples (Schwarz)."""


def with_load_wave(linear: Fit, whitened: Sequence[Problem], hints: LoopHints) -> float:
    """Return the log likelihood (nats, less a constant) of a process beside a load that is a sinusoid.

    Args:
        linear: The best process without a valve.
        whitened: The record behind each filter.
        hints: Prior knowledge about the loop.
    """
    likely, fit, before = -math.inf, linear, math.inf
    price = NUMBERS / 2 * math.log(float(whitened[0].weight.sum()))
    for _ in range(TURNS):
        behind = whitened[fit.noise]
        frequency = _highest(residuals(fit.candidate, fit.structure, behind), behind.weight)
        if abs(frequency - before) * len(behind.pv) < SETTLED:
            break
        before = frequency
        beside = [beside_wave(each, frequency) for each in whitened]
        found = best_process(beside, hints)
        if found is None:
            break
        fit = found
        likely = max(likely, log_likelihood(fit, beside[fit.noise]) - price)
    return likely


def _highest(left: FloatArray, weight: FloatArray) -> float:
    """Return the frequency of the highest line of a residual, (m,), cycles per block."""
    m = len(left)
    power = np.abs(np.fft.rfft(left * weight, FINER * m)) ** 2
    power[: math.ceil(CYCLES * FINER)] = 0.0
    at = np.arange(m)

    def missed(frequency: float) -> float:
        return -abs(complex(np.exp(-2j * np.pi * frequency * at) @ (left * weight)))

    middle, apart = int(np.argmax(power)) / (FINER * m), 1 / (FINER * m)
    return float(minimize_scalar(missed, bounds=(middle - apart, middle + apart), method="bounded").x)


def beside_wave(problem: Problem, frequency: float) -> Problem:
    """Return the problem with a sinusoid of this frequency, of any amplitude and phase, projected out."""
    turns = 2 * np.pi * frequency * np.arange(len(problem.pv))
    wave = np.column_stack((np.cos(turns), np.sin(turns))) * problem.weight[:, None]
    basis = np.asfortranarray(np.linalg.qr(np.column_stack((problem.basis, wave)))[0])
    pv = (problem.pv - basis @ (basis.T @ (problem.pv * problem.weight))) * problem.weight
    return problem._replace(pv=pv, basis=basis)
