"""Measured inputs in several recordings of one loop: their law is shared, each has its own course of them."""

import json
from dataclasses import replace

import numpy as np
import pytest
from loops import made

from agent.cli.comparing.several import together, together_json, together_lines
from agent.physics.bases.linear_process import lagged
from agent.physics.effects import EFFECTS
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
