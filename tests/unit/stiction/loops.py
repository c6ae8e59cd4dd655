"""Signals of known shape, and simulated loops, for the tests of the detectors."""

from functools import cache

import numpy as np

from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import Oscillation
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate

REGULAR = 3.0


def sines(n, period, phase):
    """OP and PV, PV the given phase behind."""
    angle = 2 * np.pi * np.arange(n) / period
    return np.sin(angle), np.sin(angle - phase)


def detect(detector, op, pv, period, *, mv=None, hints=None):
    """The result of the detector for signals that oscillate with the period, s; one sample a second."""
    window = LoopWindow("made", 0.0, 1.0, op, pv, mv=mv, hints=hints or LoopHints())
    return detector.detect(window, Oscillation(detected=True, period=period, regularity=REGULAR))


@cache
def simulated(kind, seed):
    """A simulated loop with its set point and stem, its oscillation, and its scenario."""
    scenario = random_plant(seed, kind)
    record = simulate(scenario)
    hints = LoopHints(integrating=scenario.process.kind == "integrating")
    window = LoopWindow(kind, 0.0, 1.0, record.op, record.pv, record.sp, record.mv, hints=hints)
    return window, detect_oscillation(window), scenario
