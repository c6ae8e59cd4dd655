"""What the contract of an oscillation detector demands: ``agent.analysis.oscillation``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.recording import LoopWindow
from agent.checks.contract import demand, require, require_close, where

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from agent.analysis.oscillation import OscillationDetector

N = 1000
PERIOD = 60.0
"""Samples."""
_T = np.arange(N)
_NOISE = np.random.default_rng(11).normal(size=(2, N))
OP = 50 + 5 * np.sin(2 * np.pi * _T / PERIOD) + 0.2 * _NOISE[0]
PV = 100 + 3 * np.sin(2 * np.pi * _T / PERIOD - 1.5) + 0.2 * _NOISE[1]
FALSE_ALARMS = 4
"""Of 80 records of noise: one in twenty."""


def window(op: ArrayLike = OP, pv: ArrayLike = PV, ts: float = 1.0) -> LoopWindow:
    """Return a window of a noisy wave, or of what is given."""
    return LoopWindow("x", 0.0, ts, op=np.asarray(op, np.float64), pv=np.asarray(pv, np.float64))


@demand("oscillation detector", "must see a noisy wave and its period")
def sees_a_wave(detector: OscillationDetector) -> None:
    """Show a wave of 60 samples."""
    seen = detector.detect(window())
    require(seen.detected, "it sees none")
    require_close(seen.period, PERIOD, "the period", rtol=0.02)


@demand("oscillation detector", "must give the same answer in other units and with an offset")
def units_and_offset(detector: OscillationDetector) -> None:
    """Scale and shift both signals."""
    one = detector.detect(window())
    for scale, offset in ((1e-6, 0.0), (1e6, 0.0), (-2.0, 7.0), (1.0, 1e4)):
        other = detector.detect(window(scale * OP + offset, scale * PV + offset))
        with where(f"times {scale:g} plus {offset:g}"):
            require(other.detected == one.detected, "the verdict changes")
            require_close(other.period, one.period, "the period", rtol=1e-6)
            require((other.regularity is None) == (one.regularity is None), "the regularity is lost")
            require_close(other.regularity or 0, one.regularity or 0, "the regularity", rtol=1e-3)


@demand("oscillation detector", "must give the period in seconds")
def period_in_seconds(detector: OscillationDetector) -> None:
    """Sample every 20 s."""
    require_close(detector.detect(window(ts=20.0)).period, 20 * PERIOD, "the period", rtol=0.02)


@demand("oscillation detector", "must leave gaps out of its numbers")
def gaps(detector: OscillationDetector) -> None:
    """Lose one sample in twenty of each signal."""
    lost = np.random.default_rng(3).random((2, N)) < 0.05
    seen = detector.detect(window(np.where(lost[0], np.nan, OP), np.where(lost[1], np.nan, PV)))
    for name in ("period", "regularity", "share"):
        number = getattr(seen, name)
        require(number is None or math.isfinite(number), f"the {name} is {number}")


@demand("oscillation detector", "must see nothing in a record of up to 20 samples")
def short_record(detector: OscillationDetector) -> None:
    """Cut the wave after a third of a period and earlier."""
    for n in (0, 1, 2, 3, 5, 20):
        require(not detector.detect(window(OP[:n], PV[:n])).detected, f"{n} samples: it sees an oscillation")


@demand("oscillation detector", "must see nothing, and no number, in signals that do not move")
def still_signals(detector: OscillationDetector) -> None:
    """Show constants, gaps and a ramp."""
    flat = {"zero": np.zeros(N), "1e9": np.full(N, 1e9), "only gaps": np.full(N, np.nan), "a ramp": 0.1 * _T}
    for name, values in flat.items():
        seen = detector.detect(window(values, values))
        found = (seen.detected, seen.period, seen.regularity)
        require(found == (False, None, None), f"{name}: detected, period, regularity are {found}")


@demand("oscillation detector", "must leave its input as it was and give the same answer each time")
def repeatable(detector: OscillationDetector) -> None:
    """Detect twice."""
    seen = window()
    before = seen.op.copy(), seen.pv.copy()
    one, other = detector.detect(seen), detector.detect(seen)
    require(one == other, f"first {one}, then {other}")
    require((before[0] == seen.op).all() and (before[1] == seen.pv).all(), "it changes its input")


@demand(
    "oscillation detector",
    "must see an oscillation in at most one of twenty records of noise, since it is marked noise_proof",
    lambda detector: bool(detector.noise_proof),
)
def noise(detector: OscillationDetector) -> None:
    """Show white and slow noise, a walk, and a drift with noise."""
    rng = np.random.default_rng(5)
    alarms = 0
    for _ in range(20):
        white = rng.normal(size=N)
        slow = np.convolve(rng.normal(size=N + 60), 0.95 ** np.arange(61), mode="valid")
        for values in (white, slow, np.cumsum(white), 0.02 * _T + white):
            alarms += detector.detect(window(values, values)).detected
    require(alarms <= FALSE_ALARMS, f"it sees one in {alarms} of 80")


CHECKS = (
    sees_a_wave,
    units_and_offset,
    period_in_seconds,
    gaps,
    short_record,
    still_signals,
    repeatable,
    noise,
)
"""All checks of an oscillation detector."""
