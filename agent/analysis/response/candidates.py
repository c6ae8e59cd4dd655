"""The processes that a loop may have, before its window is looked at."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.loop.pi_controller import pi_law

if TYPE_CHECKING:
    from agent.analysis.loop.pi_controller import PiController
    from agent.analysis.record.known_process import KnownProcess
    from agent.analysis.record.recording import LoopWindow

LAWFUL = 0.5
"""Share of the increments of OP that the PI law must give before its gain is believed."""
TAUS = (0.3, 1.0, 3.0)
"""Time constants that a PI controller is tuned for, over its integral time: one by SIMC (Skogestad 2003) for
a fast process, three for a slow one, whose integral time is bounded by the dead time."""
DELAYS = (0.1, 0.3, 1.0)
"""Dead times, likewise."""
LOOP_GAIN = 0.35
"""Gain of controller and process together, K kc, over ``TAUS``: SIMC gives Ti / (tau_c + delay), which is 5
where delay and tau_c are a tenth of Ti, and 0.025 where the delay is Ti and tau_c 40 times as long; this is
the geometric mean."""
UNSURE_GAIN = 1.5
"""Standard deviation of its logarithm, of what is spread evenly between both."""
FEWEST_LAWFUL = 30
"""Samples in which OP moves, from which its law is read."""
LONGEST = 1e6
"""Samples beyond which an integral time is none."""
FEWEST_TAUS = 0.5
"""Shortest time constant, samples: a faster one cannot be distinguished from a gain."""


class LikelyProcess(NamedTuple):
    """A process that the loop may have."""

    gain: float
    """PV units per OP unit, with its sign; the middle of what is possible. Per sample where it integrates."""
    log_gain_sd: float
    tau: float | None
    """Samples; None: it integrates."""
    delay: int
    """Samples, >= 1."""


def candidates(
    window: LoopWindow, known: KnownProcess | None, law: PiController | None
) -> tuple[LikelyProcess, ...]:
    """Return the processes that the loop may have; empty where nothing is known of them.

    Args:
        window: The record.
        known: The process as other windows show it; None: it is one that the controller is tuned for.
        law: The controller; None: not known.
    """
    ts = window.ts
    if known is not None:
        delay = max(1, round(known.delay / ts))
        gain = known.gain if known.tau is not None else known.gain * ts
        tau = None if known.tau is None else max(known.tau / ts, FEWEST_TAUS)
        return (LikelyProcess(gain, known.log_gain_sd, tau, delay),)
    if law is None:
        return ()
    integral_time = min(law.kc / law.ki, LONGEST)
    found = (
        LikelyProcess(
            LOOP_GAIN * over / law.kc,
            UNSURE_GAIN,
            max(over * integral_time, FEWEST_TAUS),
            max(1, math.ceil(delay * integral_time)),
        )
        for over in TAUS
        for delay in DELAYS
    )
    return tuple(dict.fromkeys(found))


def known_law(window: LoopWindow, stretch: slice) -> PiController | None:
    """Return the law of the controller as the clearest part of a record shows it; None: not known.

    Those are the whole, what lies before a stretch, and the stretch: a fault, and a limit of OP, hide it.
    """
    error = window.error
    parts = (slice(0, len(window)), slice(0, stretch.start), stretch)
    moving = np.concatenate(([True], np.diff(window.op) != 0))
    found = []
    for part in parts:
        free = moving[part]
        op = np.where(free, window.op[part], np.nan)
        if np.count_nonzero(np.isfinite(op)) >= FEWEST_LAWFUL:
            found.append(pi_law(op, error[part]))
    lawful = [law for law in found if law is not None and law.explained >= LAWFUL and law.kc * law.ki > 0]
    return max(lawful, key=lambda law: law.explained, default=None)
