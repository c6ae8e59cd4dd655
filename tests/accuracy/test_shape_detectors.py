"""How often the detectors of shape are right on the simulated loops that docs/methods counts."""

from functools import cache

import numpy as np
import pytest

from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.stiction import DETECTORS
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate

BY_NAME = {each.name: each for each in DETECTORS}


@cache
def loops(kind):
    found = []
    for seed in range(40):
        scenario = random_plant(seed, kind)
        record = simulate(scenario)
        noise = 0.05 * np.std(record.mv) * np.random.default_rng(seed).normal(size=record.mv.size)
        hints = LoopHints(integrating=scenario.process.kind == "integrating")
        mv = record.mv + noise
        window = LoopWindow(kind, 0.0, 1.0, record.op, record.pv, record.sp, mv, hints=hints)
        found.append((window, detect_oscillation(window)))
    return found


@pytest.mark.bench
@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    ("name", "least"),
    [
        ("he_curve_fit", 37),
        ("rossi_scali", 22),
        ("hagglund_shape", 4),
        ("hagglund_backlash", 10),
        ("damarla", 40),
        ("srinivasan_dtw", 30),
    ],
)
def test_sticking_valves_reported_and_swinging_loads_not(name, least):
    detect = BY_NAME[name].detect
    assert sum(detect(*loop).verdict == "stiction" for loop in loops("stiction")) >= least
    assert not any(detect(*loop).verdict == "stiction" for loop in loops("sinusoid"))
