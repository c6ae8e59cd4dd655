"""A record without noise, as somebody computes one: numbers, none of them NaN, and no crash."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.workbench.session import Workbench


def stuck(op: np.ndarray) -> np.ndarray:
    at, found = op[0], []
    for each in op:
        if abs(each - at) > 5.0:
            at = each - 2.0 * np.sign(each - at)
        found.append(at)
    return np.array(found)


@pytest.mark.parametrize("kind", ["levels", "sine", "stuck"])
def test_all_numbers_are_numbers(kind: str) -> None:
    op = np.repeat(np.random.default_rng(3).uniform(40, 60, 40), 30 if kind == "stuck" else 15)
    if kind == "sine":
        op = 50 + 10 * np.sin(np.arange(600) / 9.0)
    position = stuck(op) if kind == "stuck" else op
    pv = 20 + 2 * lfilter([0.0, 0.1], [1.0, -0.9], position - position[0])
    others = {each.family for each in EFFECTS} - {"valve_hysteresis"}
    bench = Workbench(LoopWindow("exact", 0.0, 1.0, op, pv), without=others if kind == "stuck" else ())
    bench.auto()
    numbers = [value for each in bench.step.parameters for value in (each.value, each.low, each.high)]
    assert np.isfinite(numbers).all()
    assert bench.step.effects == (("stiction",) if kind == "stuck" else ())
    assert {each.name: each.value for each in bench.step.parameters}["tau"] == pytest.approx(9.491, abs=1e-3)
