"""Stiction detectors, one published method a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.results import MethodResult
from agent.analysis.stiction.bicoherence import Bicoherence
from agent.analysis.stiction.choudhury_cmeans import ChoudhuryCmeans
from agent.analysis.stiction.choudhury_ellipse import ChoudhuryEllipse
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
from agent.analysis.stiction.thornhill_surrogates import ThornhillSurrogates
from agent.analysis.stiction.yamashita import Yamashita

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agent.analysis.gates import GateFault
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import Oscillation

__all__ = ["DETECTORS", "StictionDetector", "detect_stiction"]

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
    Bicoherence(),
    ChoudhuryEllipse(),
    ChoudhuryCmeans(),
    ThornhillSurrogates(),
)


def detect_stiction(
    window: LoopWindow, oscillation: Oscillation, faults: Iterable[GateFault] = ()
) -> dict[str, MethodResult]:
    """Return the result of each detector for ``window``, by its name.

    Args:
        window: The stretch to judge.
        oscillation: The result of ``detect_oscillation`` for it.
        faults: The faults that the gates found; a detector of a kind that one of them closes is skipped.
    """
    closed = {kind: fault.reason for fault in faults for kind in fault.closes}
    return {
        each.name: MethodResult("not_applicable", None, closed[each.kind])
        if each.kind in closed
        else each.detect(window, oscillation)
        for each in DETECTORS
    }
