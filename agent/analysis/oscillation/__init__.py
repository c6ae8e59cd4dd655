"""Oscillation detectors, one a file."""

from __future__ import annotations

from agent.analysis.oscillation.acf_filtered import AcfFiltered, oscillations
from agent.analysis.oscillation.acf_zero_crossings import AcfZeroCrossings
from agent.analysis.oscillation.broad_peak import BroadPeak
from agent.analysis.oscillation.detector import OscillationDetector
from agent.analysis.oscillation.forsman_stattin import ForsmanStattin, ForsmanStattinMonitor
from agent.analysis.oscillation.hagglund import HagglundIae, HagglundMonitor
from agent.analysis.oscillation.miao_seborg import MiaoSeborg
from agent.analysis.oscillation.spectral import SpectralPeak
from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import Oscillation

__all__ = [
    "DETECTORS",
    "ForsmanStattinMonitor",
    "HagglundMonitor",
    "OscillationDetector",
    "detect_oscillation",
    "oscillations",
]

DETECTORS: tuple[OscillationDetector, ...] = (
    HagglundIae(),
    AcfZeroCrossings(),
    ForsmanStattin(),
    MiaoSeborg(),
    SpectralPeak(),
    AcfFiltered(),
    BroadPeak(),
)


def detect_oscillation(window: LoopWindow) -> Oscillation:
    """Combine the detectors: the loop oscillates where a noise-proof one of them finds an oscillation.

    The others decide only where the wave is regular as well. The most regular answer gives the period; that
    of a single peak of the spectrum only where the signal as a whole is not regular, because a filter makes
    every wave more regular. A regularity of None means that the oscillation was found by its power or its
    decay alone.
    """
    answers = [(detector, detector.detect(window)) for detector in DETECTORS]
    decisive = [
        answer
        for detector, answer in answers
        if answer.detected and (detector.noise_proof or (answer.regularity or 0.0) > 1)
    ]
    known = decisive or [answer for _, answer in answers if answer.regularity is not None]
    if not known:
        return Oscillation(detected=False, period=None, regularity=None)
    best = max(known, key=_standing)
    return Oscillation(bool(decisive), best.period, best.regularity, best.share)


def _standing(answer: Oscillation) -> tuple[bool, bool, float]:
    """Order answers by the quality of their period: regular ones first, then those of the whole signal."""
    return answer.regularity is not None, answer.share is None, answer.regularity or 0.0
