"""Measured inputs beside OP: found with their gain, dead time and lag, and only the one that acts."""

from dataclasses import replace

import numpy as np
import pytest
from loops import made

from agent.analysis.record.recording import LoopWindow
from agent.checks.effect_record import FACTS, SAMPLES
from agent.physics.bases import Fopdt
from agent.physics.bases.linear_process import lagged
from agent.physics.effects import EFFECTS
from agent.physics.loop_model import LoopModel
from agent.report.comparison_text import step_name
from agent.workbench.candidates import BY_COURSE
from agent.workbench.checks.mended import LITTLE
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


def stepped(height, noise):
    """A loop on which an input acts that moves nine times, behind two lags, and the input."""
    window, rng, feed = made(noise=noise), np.random.default_rng(50), np.zeros(800)
    for at in range(60, len(feed), 90):
        feed[at:] += rng.normal()
    return replace(window, pv=window.pv + height * lagged(lagged(feed, 80), 20)), feed


@pytest.mark.parametrize(("height", "noise"), [(3.0, 0.2), (10.0, 0.05)])
def test_an_input_of_few_moves_is_found_though_an_autoregression_follows_it(height, noise):
    window, feed = stepped(height, noise)
    bench = Workbench(window, without=[*FEW, "disturbance"], inputs={"FEED": feed})
    decision = bench.candidates()
    assert (decision.kind, decision.effect) == ("confirmed", "FEED")
    (found,) = [each for each in decision.candidates if each.effect == "FEED"]
    assert found.error_reduction_percent > 60
    # From its first fit, behind the autoregression of that, a search predicts no worse.
    (begun,) = bench.trials.begun.of(bench.step, [bench.effect("FEED")])
    assert found.criterion > begun.first.criterion - 5


def heated(samples=800):
    """A slow loop in manual, with a lag of its sensor, and a second heater that moves eight times."""
    rng, period = np.random.default_rng(6), 3.0
    op, other = np.zeros(samples), np.zeros(samples)
    for start in range(10, samples, 90):
        op[start:] = rng.uniform(0, 80)
        other[start + 37 :] = rng.uniform(0, 70)
    own = 0.6 * lagged(lagged(op, 130 / period), 20 / period)
    pv = 25 + own + 0.3 * lagged(lagged(other, 250 / period), 100 / period)
    pv = np.round((pv + 0.15 * rng.standard_normal(samples)) / 0.3) * 0.3
    return LoopWindow("heated", 0.0, period, op, pv), other


def test_an_input_behind_a_lag_that_the_model_lacks_is_found_beyond_it():
    window, other = heated()
    few = [*FEW, "disturbance", "gain"]
    few.remove("extra_lag")
    bench = Workbench(window, without=few, inputs={"OTHER": other})
    decision = bench.candidates()
    assert decision.kind == "none"
    (alone,) = [each for each in decision.candidates if each.effect == "OTHER"]
    assert alone.odds <= 0
    base, lag, step = bench.auto()
    assert (lag.verdict.kind, lag.verdict.lacks) == ("suggested", (LITTLE,))
    assert step.effects == (lag.added, "OTHER")
    assert step.verdict.kind == "confirmed"
    assert step.held_out.rmse < 0.6 * base.held_out.rmse
    assert [step_name(each) for each in (lag, step)] == [f"+ {lag.added} (perhaps)", "+ OTHER"]


def test_what_mends_a_failure_by_little_is_not_added_where_nothing_is_confirmed_beyond():
    window, _ = heated()
    few = [*FEW, "disturbance", "gain"]
    few.remove("extra_lag")
    bench = Workbench(window, without=few)
    assert len(bench.auto()) == 1
    assert bench.comparison().verdict.lacks[0] == LITTLE


def test_a_load_beside_what_acts_on_op_is_no_part_of_its_law():
    window, feed = fed()
    bench = Workbench(window, without=[*FEW, "disturbance", "gain"], inputs={"FEED": feed})
    effects = [bench.effect("FEED")]
    found = bench.trials.judged_on(bench.step, effects).decision.candidates[0]
    strict = replace(bench.step, of_laws=50 * found.criterion)
    assert bench.trials.judged_on(strict, effects).decision.kind == "confirmed"


def test_a_slow_input_that_does_not_act_is_rejected_in_words():
    window = made(noise=0.05, seed=7)
    slow = lagged(np.random.default_rng(3).standard_normal(800).cumsum(), 60)
    window = replace(window, pv=window.pv + 0.05 * np.random.default_rng(4).standard_normal(800).cumsum())
    bench = Workbench(window, without=[*FEW, "disturbance", "gain"], inputs={"FEED": slow})
    decision = bench.candidates()
    assert decision.kind == "none"
    assert all(each.objection in {BY_COURSE, None} for each in decision.candidates)
    assert all(each.odds <= 0 for each in decision.candidates)


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
