"""Stiction detectors, one published method a file."""

from __future__ import annotations

from agent.analysis.stiction.damarla import Damarla
from agent.analysis.stiction.detector import StictionDetector
from agent.analysis.stiction.hagglund_backlash import HagglundBacklash
from agent.analysis.stiction.hagglund_shape import HagglundShape
from agent.analysis.stiction.he_curve_fit import HeCurveFit
from agent.analysis.stiction.horch_ccf import HorchCcf
from agent.analysis.stiction.horch_histogram import HorchHistogram
from agent.analysis.stiction.kano_a import KanoA
from agent.analysis.stiction.kano_b import KanoB
from agent.analysis.stiction.rossi_scali import RossiScali
from agent.analysis.stiction.singhal_salsbury import SinghalSalsbury
from agent.analysis.stiction.srinivasan_dtw import SrinivasanDtw
from agent.analysis.stiction.yamashita import Yamashita

__all__ = ["DETECTORS", "StictionDetector"]

DETECTORS: tuple[StictionDetector, ...] = (
    HorchCcf(),
    HorchHistogram(),
    SinghalSalsbury(),
    KanoA(),
    KanoB(),
    Yamashita(),
    HeCurveFit(),
    RossiScali(),
    HagglundShape(),
    HagglundBacklash(),
    Damarla(),
    SrinivasanDtw(),
)
