"""Numbers that are solved for: gain, heights, amplitude, phase, with intervals; one step is one step."""

import numpy as np
import pytest
from loops import GAIN, made

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.report.comparison_json import comparison_json
from agent.workbench.session import Workbench

FAMILIES = {each.family for each in EFFECTS} - {"disturbance", "gain"}
T = np.arange(800.0)


def disturbed(by, noise=0.05):
    window = made(noise=noise)
    return LoopWindow("loop", 0.0, 1.0, window.op, window.pv + by)


def numbers(bench):
    return {each.name: each for each in bench.step.numbers}


def test_gain_amplitude_and_phase_are_those_of_the_loop():
    bench = Workbench(
        disturbed(2.0 * np.cos(2 * np.pi * 0.011 * T + 1.0)), without=[*FAMILIES, "gain", "load_step"]
    )
    bench.add("sinusoid")
    found = numbers(bench)
    for name, truth in (("gain", GAIN), ("sinusoid.amplitude", 2.0), ("sinusoid.phase", 1.0)):
        assert found[name].value == pytest.approx(truth, abs=0.05)
        assert found[name].low < found[name].value < found[name].high
        assert found[name].high - found[name].low < 0.2
    written = comparison_json(bench.comparison(), "loop.csv")["steps"][-1]["parameters"]
    assert written["gain"]["unit"] == "PV/OP"
    assert written["sinusoid.amplitude"]["value"] == pytest.approx(2.0, abs=0.05)
    assert "gain" not in bench.save()["parameters"]


def test_a_load_that_steps_once_at_once_is_one_step_and_confirmed():
    bench = Workbench(disturbed(np.where(T > 400, 3.0, 0.0)), without=[*FAMILIES, "gain", "sinusoid"])
    step = bench.add("load_step")
    assert step.verdict.kind == "confirmed"
    found = numbers(bench)
    assert found["load_step.height"].value == pytest.approx(3.0, abs=0.1)
    assert not {"load_step.height_2", "load_step.time_2"} & set(found)
    other = Workbench(disturbed(np.where(T > 400, 3.0, 0.0)), without=[*FAMILIES, "gain", "sinusoid"])
    other.load(bench.save())
    assert other.step.rmse_fit == pytest.approx(step.rmse_fit, rel=0.05)
