"""Stiction detectors, one published method a file."""

from __future__ import annotations

from agent.analysis.stiction.detector import StictionDetector
from agent.analysis.stiction.horch_ccf import HorchCcf
from agent.analysis.stiction.horch_histogram import HorchHistogram
from agent.analysis.stiction.singhal_salsbury import SinghalSalsbury

__all__ = ["DETECTORS", "StictionDetector"]

DETECTORS: tuple[StictionDetector, ...] = (
    HorchCcf(),
    HorchHistogram(),
    SinghalSalsbury(),
)
