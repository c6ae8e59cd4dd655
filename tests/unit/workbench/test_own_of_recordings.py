"""What each of several recordings has for itself: a measured input's course, a wave with its harmonics."""

import json
from dataclasses import replace

import numpy as np
import pytest
from loops import made

from agent.cli.comparing.several import together, together_json, together_lines
from agent.physics.bases.linear_process import lagged
from agent.physics.effects import EFFECTS
from agent.plots.workbench.several_report import together_html
from agent.workbench.hooks import silent
from agent.workbench.several.together import NOT_LOWER

GAIN, LAG = 0.5, 12.0
FEW = tuple({each.family for each in EFFECTS})


def fed(seed, samples=500):
    """A recording of a loop on which a feed acts, with the feed and an unrelated temperature."""
    window = made(noise=0.2, seed=seed, samples=samples)
    feed, other = np.random.default_rng([5, seed]).standard_normal((2, samples)).cumsum(axis=1)
    return replace(window, pv=window.pv + GAIN * lagged(feed, LAG)), {"FEED": feed, "TEMP": other}


def compared(recorded, validate=None, *, auto=False):
    return together(recorded, "fopdt", FEW, EFFECTS, (), map, silent, auto=auto, validate=validate)


@pytest.fixture(scope="module")
def found():
    return compared({"a": fed(1), "b": fed(2)}, fed(3), auto=True)


def test_the_one_that_acts_is_named_with_one_law_and_a_gain_of_each_recording(found):
    base, step = found.steps
    assert step.effects == ("FEED",)
    content = json.loads(together_json(found))["steps"][1]
    lag = content["parameters"]["FEED.lag"]
    assert lag["low"] < LAG < lag["high"]
    assert set(content["own"]) == {"a", "b"}
    for each in content["own"].values():
        assert each["FEED.gain"] == pytest.approx(GAIN, rel=0.15)
    assert all(
        after < 0.5 * before for after, before in zip(step.rmse_held_out, base.rmse_held_out, strict=True)
    )
    assert step.rmse_validation < 0.5 * base.rmse_validation
    assert "FEED.gain 0.5" in "\n".join(together_lines(found))


def test_the_one_that_does_not_act_is_tried_and_rejected(found):
    (other,) = [each for each in found.candidates if each.effect == "TEMP"]
    assert other.objection is not None
    assert other.objection == NOT_LOWER or other.criterion < 0


def test_a_recording_for_validation_without_an_input_is_named():
    window, _ = fed(3)
    none = compared({"a": fed(1), "b": fed(2)}, (window, {}))
    assert none.not_validated.endswith("no input FEED")
    assert none.steps[0].rmse_validation is None
    assert none.verdict.kind != "not_testable"


def test_a_recording_in_which_an_input_stands_is_named():
    window, inputs = fed(2)
    with pytest.raises(ValueError, match=r"^b: input FEED does not move$"):
        compared({"a": fed(1), "b": (window, {**inputs, "FEED": np.zeros(500)})})


def waving(seed, square, samples=600):
    """A recording with a load that repeats itself: of edges, or of two harmonics."""
    window = made(noise=0.1, seed=seed, samples=samples)
    turns = np.arange(samples) / 61.0
    load = np.sin(2 * np.pi * turns) + 0.4 * np.sin(4 * np.pi * turns + 1)
    load = np.where(turns % 1 < 0.5, 1.0, -1.0) if square else load
    return replace(window, pv=window.pv + 2 * load), {}


def test_a_wave_has_as_many_harmonics_as_its_recording_needs():
    recorded = {"a": waving(1, square=True), "b": waving(2, square=False)}
    without = tuple({each.family for each in EFFECTS} - {"disturbance"})
    found = together(
        recorded, "fopdt", without, EFFECTS, (), map, silent, auto=True, validate=waving(3, square=False)
    )
    base, step = found.steps
    assert step.effects == ("wave",)
    assert step.rmse_validation < 0.2 * base.rmse_validation
    edges, two = step.fitted.own()
    assert len(edges) > len(two)
    printed = "\n".join([*together_lines(found), together_html(found)])
    assert "wave.amplitude_3" in printed
    assert "wave.amplitude_4" not in printed
