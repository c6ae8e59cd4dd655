"""Oscillation detectors, one a file."""

from __future__ import annotations

from agent.analysis.oscillation.acf_zero_crossings import AcfZeroCrossings
from agent.analysis.oscillation.detector import OscillationDetector
from agent.analysis.oscillation.hagglund import HagglundIae, HagglundMonitor
from agent.analysis.recording import LoopWindow
from agent.analysis.results import Oscillation

__all__ = ["DETECTORS", "HagglundMonitor", "OscillationDetector", "detect_oscillation"]

DETECTORS: tuple[OscillationDetector, ...] = (HagglundIae(), AcfZeroCrossings())


def detect_oscillation(window: LoopWindow) -> Oscillation:
    """Combine the detectors: the loop oscillates where one of them sees a wave that is regular as well.

    Loads alone come from slow noise too, so a detector that has no regularity above 1 does not decide.
    The most regular answer gives the period.
    """
    answers = [detector.detect(window) for detector in DETECTORS]
    regular = [answer for answer in answers if answer.detected and (answer.regularity or 0.0) > 1]
    known = [answer for answer in answers if answer.regularity is not None]
    best = max(regular or known, key=lambda answer: answer.regularity or 0.0, default=None)
    if best is None:
        return Oscillation(detected=False, period=None, regularity=None)
    return Oscillation(bool(regular), best.period, best.regularity)
