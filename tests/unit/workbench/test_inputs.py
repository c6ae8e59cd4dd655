"""Measured inputs beside OP: found with their gain, dead time and lag, and only the one that acts."""

import numpy as np
import pytest
from loops import made

from agent.analysis.record.recording import LoopWindow
from agent.checks.effect_record import FACTS, SAMPLES
from agent.physics.bases import Fopdt
from agent.physics.bases.linear_process import lagged
from agent.physics.effects import EFFECTS
from agent.physics.loop_model import LoopModel
from agent.workbench.inputs.measured_input import MeasuredInput, measured_inputs
from agent.workbench.session import Workbench

GAIN, DELAY, LAG = -0.8, 6.0, 12.0
FEW = tuple({each.family for each in EFFECTS} - {"disturbance", "gain"})


def course(seed, samples=800):
    rng = np.random.default_rng([77, seed])
    return np.cumsum(rng.standard_normal(samples)) * 0.1 + np.repeat(rng.normal(0, 1, samples // 80), 80)


def fed(seed=0):
    """A loop on which an input acts, and the input."""
    window, feed = made(noise=0.05, seed=seed), course(seed)
    late = np.concatenate((np.full(int(DELAY), feed[0]), feed[: -int(DELAY)]))
    return LoopWindow("fed", 0.0, 1.0, window.op, window.pv + GAIN * lagged(late, LAG)), feed


def test_the_input_that_acts_is_confirmed_and_the_other_is_not():
    window, feed = fed()
    other, other_feed = fed(5)
    bench = Workbench(
        window,
        validate=other,
        without=FEW,
        inputs={"FEED": feed, "TEMP": course(3)},
        other_inputs={"FEED": other_feed, "TEMP": course(4)},
    )
    base, step = bench.auto()
    assert step.effects == ("FEED",)
    assert step.verdict.family == "measured_input"
    found = {each.name: each for each in step.parameters}
    assert found["FEED.delay"].low - 0.3 < DELAY < found["FEED.delay"].high + 0.3
    assert found["FEED.lag"].value == pytest.approx(LAG, rel=0.1)
    assert step.rmse_validation < 0.3 * base.rmse_validation
    assert next(each for each in bench.candidates().candidates if each.effect == "TEMP").p > 0.05


def test_a_recording_for_validation_without_the_input_is_named():
    window, feed = fed()
    bench = Workbench(
        window, validate=fed(5)[0], without=[*FEW, "disturbance", "gain"], inputs={"FEED": feed}
    )
    assert bench.step.rmse_validation is None
    assert "no input FEED" in bench.not_validated


def test_it_is_an_effect_like_others():
    values = np.sin(np.arange(SAMPLES) / 9)
    model = LoopModel(Fopdt(), (MeasuredInput("FEED", values),))
    columns = model.columns(np.zeros(SAMPLES), np.array([3.0, 5.0, 0.0, 0.2]), FACTS)
    assert columns[:, 1] == pytest.approx(values - values.mean(), abs=0.1)


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        ({"stiction": np.arange(9.0)}, "cannot be named 'stiction'"),
        ({"a b": np.arange(9.0)}, "cannot be named 'a b'"),
        ({"FEED": np.arange(8.0)}, "has 8 samples, OP has 9"),
        ({"FEED": np.full(9, 3.0)}, "does not move"),
        ({"FEED": np.full(9, np.nan)}, "does not move"),
    ],
)
def test_what_is_no_input_is_named(inputs, words):
    with pytest.raises(ValueError, match=words):
        measured_inputs(inputs, {}, 9, {"stiction"})
