"""Why a loop swings whose valve does not stick: too tight a controller, or something from outside.

A first, thin answer. A swing that keeps its phase over the whole record is driven by a clock outside: a loop
that is merely close to instability swings with the noise and loses its phase. For the rest the free run of
the linear model decides: what OP does to PV the model shows, what comes from elsewhere stays in its
residual. See ``docs/methods/diagnosis.md`` for what it cannot distinguish.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.recording import FloatArray, LoopWindow
from agent.analysis.results import CauseShare, Oscillation, Quantification

EXPLAINED = 0.8
"""Part of the swing of PV that OP must explain before the controller is blamed."""
UNEXPLAINED = 0.5
"""Below this part the swing comes from outside."""
COHERENT = 0.8
"""Part of PV's variance in one wave of constant phase that only a source outside keeps up.

Between what simulated loops show: at most 0.65 in 40 tightly tuned ones, at least 0.93 in 40 with a
sinusoidal load (``simulators.draws.random_plants``, 2000 samples).
"""
COHERENT_REST = 0.4
"""The same of what a sticking valve's model leaves, to blame a disturbance beside it.

Of 25 simulated limit cycles none leaves a swing at all; of 25 whose load swings as well 9 leave one above
this (``random_plants`` and ``random_moves``, seeds 3000 to 3024); most of the others have fallen in step.
"""


def undecided_cause(oscillation: Oscillation) -> CauseShare:
    """Return the cause where it is not known what the valve does; whether the loop oscillates is known."""
    return CauseShare("undecided" if oscillation.detected else "no_oscillation", 1.0)


def line_power(signal: FloatArray, period: float) -> float:
    """Return the mean square of the wave of ``period`` (samples) in ``signal`` (n,), NaN left out.

    Least squares of sine and cosine beside a line, so that gaps, broken periods and drift do no harm.
    """
    finite = np.isfinite(signal)
    time = np.flatnonzero(finite) / len(signal)
    angle = 2 * np.pi * len(signal) / period * time
    wave = np.column_stack((np.cos(angle), np.sin(angle), np.ones(len(time)), time))
    weights = np.linalg.lstsq(wave, signal[finite], rcond=None)[0]
    return float(np.sum(weights[:2] ** 2) / 2)


def swing_explained(window: LoopWindow, model_pv: FloatArray, period: float) -> float:
    """Return the part of PV's wave of ``period`` (s) that the model's PV (n,) follows, 0 to 1."""
    samples = period / window.ts
    whole = line_power(window.pv, samples)
    return 0.0 if whole <= 0 else max(0.0, 1.0 - line_power(window.pv - model_pv, samples) / whole)


def coherent_share(window: LoopWindow, period: float) -> float:
    """Return the part of PV's variance that one wave of constant phase near ``period`` (s) holds, 0 to 1."""
    n, known = len(window), window.pv[np.isfinite(window.pv)]
    spread = float(np.var(known))
    cycles = n * window.ts / period
    tried = np.linspace(0.9 * cycles, 1.1 * cycles, 81)
    power = max(line_power(window.pv, n / each) for each in tried)
    return 0.0 if spread <= 0 else min(1.0, power / spread)


def cause_without_stiction(
    window: LoopWindow, oscillation: Oscillation, quantification: Quantification
) -> tuple[CauseShare, ...]:
    """Return the causes of the oscillation, the largest first; never stiction.

    Args:
        window: A record whose valve does not stick.
        oscillation: What was seen in it.
        quantification: Gives the PV of the model without stiction.
    """
    if not oscillation.detected or oscillation.period is None:
        return (CauseShare("no_oscillation", 1.0),)
    if quantification.model_pv is None:
        return (CauseShare("undecided", 1.0),)
    coherent = coherent_share(window, oscillation.period)
    if coherent >= COHERENT:
        return (CauseShare("external_disturbance", coherent), CauseShare("undecided", 1 - coherent))
    explained = swing_explained(window, quantification.model_pv, oscillation.period)
    if explained >= EXPLAINED:
        return (CauseShare("tight_tuning", explained), CauseShare("external_disturbance", 1 - explained))
    if explained <= UNEXPLAINED:
        return (CauseShare("external_disturbance", 1 - explained), CauseShare("tight_tuning", explained))
    return (CauseShare("undecided", 1.0),)


def causes_with_stiction(window: LoopWindow, quantification: Quantification) -> tuple[CauseShare, ...]:
    """Return stiction, and beside it a disturbance where one swings in what the valve leaves unexplained.

    A limit cycle loses its phase with the noise, and so does what the model misses of it; the wave of a
    source outside keeps it. A disturbance that the limit cycle has fallen in step with is seldom seen.
    """
    if quantification.model_pv is None:
        return (CauseShare("stiction", 1.0),)
    left = window.pv - quantification.model_pv
    rest = replace(window, op=left, pv=left, sp=None)  # OP would answer for the limit cycle
    swing = detect_oscillation(rest)
    if not swing.detected or swing.period is None:
        return (CauseShare("stiction", 1.0),)
    coherent = coherent_share(rest, swing.period)
    if coherent < COHERENT_REST:
        return (CauseShare("stiction", 1.0),)
    outside = min(0.5, coherent * float(np.nanvar(rest.pv) / np.nanvar(window.pv)))
    return (CauseShare("stiction", 1 - outside), CauseShare("external_disturbance", outside))
