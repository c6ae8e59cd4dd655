"""Stiction detectors, one published method a file."""

from __future__ import annotations

from agent.analysis.stiction.detector import StictionDetector
from agent.analysis.stiction.horch_ccf import HorchCcf

__all__ = ["DETECTORS", "StictionDetector"]

DETECTORS: tuple[StictionDetector, ...] = (HorchCcf(),)
