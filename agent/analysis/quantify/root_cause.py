"""Which of stiction, tuning and load makes a loop oscillate: the analysis of Karra and Karim (2009).

Without stiction the identified process is closed with the identified PI controller. If that loop on its own
oscillates at the period of the record, the controller is too tight. If the bias eta of the process oscillates
at that period, the oscillation comes from outside. Both can be true. Ours: the loop is not simulated, its
poles are computed instead.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.cause import COHERENT, coherent_share, line_power, swing_explained
from agent.analysis.loop.controller_action import process_gain_sign
from agent.analysis.loop.pi_controller import PiController, pi_controller
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.quantify.processes.armax import Armax, fit_armax
from agent.analysis.quantify.processes.output_error import plausible
from agent.analysis.quantify.valves.valve_law import valve_position
from agent.analysis.results import CauseShare

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.quantify.valves.joint_fit import CentredRecord
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import Quantification
    from agent.physics.processes.arx import Arx

WALKS = (0.03, 0.1, 0.3, 1.0)
"""Steps of the bias that are tried; the likelihood decides. They let eta follow an oscillation."""
LINGERS = 0.5
"""Decay ratio over one period from which a loop counts as oscillating; 0.25 is a usual tuning."""
SAME_PERIOD = 0.25
"""Difference up to which a period is the record's, as a part of it."""
KNOWN_LAW = 0.8
"""Share of the increments of OP that a PI law must explain before the loop is closed with it."""


SWINGING_BIAS = 0.5
"""Part of the variance of eta in the wave of the record's period from which the load oscillates."""


def root_cause(
    window: LoopWindow,
    record: CentredRecord,
    found: Quantification,
    delays: NDArray[np.int64],
    structures: tuple[int, ...],
) -> tuple[CauseShare, ...]:
    """Return the causes of the oscillation, the largest first; what they do not cover is undecided.

    The share of stiction is the part of PV's wave that the model follows, that of tuning the decay ratio of
    the closed loop over a period, that of a load the part of its bias, or of PV, in one wave with a constant
    phase. The last is ours (see ``agent.analysis.cause``): a perfect sine may come from a load or from a loop
    at the limit of stability, and EARMAX then decides for the loop.

    Args:
        window: The record as it came.
        record: The same as it was fitted.
        found: The verdict on its valve.
        delays: Delays to try for the process without stiction, samples.
        structures: Structures to try.
    """
    oscillation = detect_oscillation(window)
    if not oscillation.detected or oscillation.period is None:
        return (CauseShare("no_oscillation", 1.0),)
    if found.decision == "undecided" or found.model_pv is None:
        return (CauseShare("undecided", 1.0),)
    if found.decision == "stiction":
        explained = swing_explained(window, found.model_pv, oscillation.period)
        return _with_rest([CauseShare("stiction", explained)])
    coherent = coherent_share(window, oscillation.period)
    if coherent >= COHERENT:
        return _with_rest([CauseShare("external_disturbance", coherent)])
    linear = _linear_model(replace(record, gain_sign=process_gain_sign(window)), delays, structures)
    if linear is None:
        return (CauseShare("undecided", 1.0),)
    shares = []
    samples = oscillation.period / window.ts
    load = line_power(linear.eta, samples) / max(float(np.var(linear.eta)), 1e-300)
    if load >= SWINGING_BIAS:
        shares.append(CauseShare("external_disturbance", min(load, 1.0)))
    controller = pi_controller(window)
    if controller is not None and controller.explained >= KNOWN_LAW:
        period, left = own_swing(linear.process, controller)
        if left >= LINGERS and abs(period / samples - 1) <= SAME_PERIOD:
            shares.append(CauseShare("tight_tuning", left))
    return _with_rest(shares)


def _with_rest(shares: list[CauseShare]) -> tuple[CauseShare, ...]:
    """Return the shares scaled to at most one together, the largest first, with the rest undecided."""
    total = sum(each.share for each in shares)
    scaled = [CauseShare(each.cause, each.share / max(total, 1.0)) for each in shares]
    scaled.append(CauseShare("undecided", max(0.0, 1.0 - total)))
    return tuple(sorted((each for each in scaled if each.share > 0), key=lambda each: -each.share))


def own_swing(process: Arx, controller: PiController) -> tuple[float, float]:
    """Return period (samples) and decay ratio over it of the closed loop's slowest decaying oscillation.

    Infinite and zero where no pole oscillates.
    """
    length = process.delay + 4
    characteristic = np.zeros(length)
    characteristic[:4] += np.convolve([1.0, -1.0], [1.0, -process.a1, -process.a2])
    pi = [controller.kc + controller.ki, -controller.kc]
    characteristic[process.delay : process.delay + 3] += np.convolve(pi, [process.b1, process.b2])
    poles = np.roots(characteristic)
    poles = poles[poles.imag > 1e-9]
    if not poles.size:
        return math.inf, 0.0
    slowest = poles[np.argmax(np.abs(poles))]
    period = 2 * math.pi / float(np.angle(slowest))
    return period, float(min(np.abs(slowest) ** period, 1.0))


def _linear_model(
    record: CentredRecord, delays: NDArray[np.int64], structures: tuple[int, ...]
) -> Armax | None:
    """Return the most likely plausible process without stiction beside a bias that may oscillate."""
    mv = valve_position(record.op, 0.0, 0.0, record.law)
    fits = (
        fit_armax(mv, record.pv, int(delay), structure, 1, walk)
        for structure in structures
        for delay in delays
        for walk in WALKS
    )
    sound = [fit for fit in fits if plausible(fit.process, record.gain_sign)]
    return min(sound, key=lambda fit: fit.aic, default=None)
