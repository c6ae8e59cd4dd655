"""Several recordings of one loop: one model over all says what none of them shows alone."""

import json

import numpy as np
import pytest
from loops import DELAY, GAIN, LEVEL, STEM, TAU

from agent.analysis.record.recording import LoopWindow
from agent.cli.comparing.several import names_of, together_json, together_lines
from agent.physics.bases import Fopdt
from agent.physics.effects.deadband import Deadband
from agent.physics.loop_model import LoopModel
from agent.plots.workbench.several_report import together_html
from agent.report.headline import capital
from agent.workbench.candidates import WORSE_ELSEWHERE
from agent.workbench.record import bare_record
from agent.workbench.session import Workbench
from agent.workbench.several.together import compared_together

WITHOUT = ("valve_limits", "valve_characteristic", "valve_speed", "disturbance", "gain", "stiction")
WITHOUT += ("asymmetric_stiction", "process_dynamics", "pv_gain", "sensor_hysteresis", "process_delay")
BAND = 1.5
NOISE = 0.285
"""Chosen between the noise with which one recording names the band and that with which two do not."""


def swinging(amplitude, seed, band=BAND, noise=NOISE, samples=500):
    """OP that swings nearly evenly: the lag and the loss of a band look like another delay and gain."""
    t = np.arange(samples)
    op = 50 + amplitude * np.sin(2 * np.pi * t / 40 + 0.2 * np.sin(2 * np.pi * t / 330))
    model = LoopModel(Fopdt(), (Deadband(),))
    facts = bare_record(LoopWindow("loop", 0.0, 1.0, op, op)).facts
    response = model.columns(op, np.array([DELAY, TAU, band, 0.0, STEM]), facts)[:, 0]
    pv = LEVEL + GAIN * response + noise * np.random.default_rng(seed).standard_normal(samples)
    return LoopWindow("loop", 0.0, 1.0, op, pv)


def benches(**windows):
    return {name: Workbench(each, without=WITHOUT) for name, each in windows.items()}


@pytest.fixture(scope="module")
def found():
    return compared_together(
        benches(a=swinging(5.0, 1), b=swinging(2.0, 2)), (), auto=True, validate=swinging(3.5, 6)
    )


@pytest.mark.parametrize(("amplitude", "seed"), [(5.0, 1), (2.0, 2)])
def test_one_recording_alone_does_not_confirm_the_band(amplitude, seed):
    bench = Workbench(swinging(amplitude, seed), without=WITHOUT)
    assert bench.candidates().kind not in {"confirmed", "family"}


def test_both_together_name_it_and_its_width(found):
    base, step = found.steps
    assert step.effects == ("deadband",)
    width = json.loads(together_json(found))["steps"][1]["parameters"]["deadband.s"]
    assert width["low"] < width["value"] < width["high"]
    assert width["value"] == pytest.approx(BAND, rel=0.3)
    assert all(after < before for after, before in zip(step.rmse_held_out, base.rmse_held_out, strict=True))


def test_the_answer_has_what_is_shared_once_and_what_is_own_for_each(found):
    content = json.loads(together_json(found))
    assert content["recordings"] == ["a", "b"]
    last = content["steps"][-1]
    assert "deadband.start" not in last["parameters"]
    assert all(set(each) == {"gain", "deadband.start"} for each in last["own"].values())
    assert all(each["gain"] == pytest.approx(GAIN, rel=0.2) for each in last["own"].values())
    assert "+ deadband" in "\n".join(together_lines(found))


def test_where_nothing_is_missing_nothing_is_named():
    none = compared_together(benches(a=swinging(5.0, 3, 0.0), b=swinging(2.0, 4, 0.0)), (), auto=True)
    assert [each.effects for each in none.steps] == [()]
    assert none.verdict.effect is None


def test_a_parameter_may_be_each_recordings_own_and_one_that_cannot_serve_is_named():
    still = LoopWindow("loop", 0.0, 1.0, np.full(500, 50.0), swinging(5.0, 5).pv)
    windows = benches(a=swinging(5.0, 1), b=swinging(2.0, 2), still=still)
    own = compared_together(windows, ("tau",), auto=False, validate=still)
    assert own.not_validated.startswith("loop cannot validate anything")
    assert own.steps[0].rmse_validation is None
    assert own.recordings == ("a", "b")
    assert set(own.left_out) == {"still"}
    content = json.loads(together_json(own))
    assert set(content["steps"][0]["parameters"]) == {"delay"}
    assert all("tau" in each for each in content["steps"][0]["own"].values())
    with pytest.raises(ValueError, match="two recordings at least"):
        compared_together({name: windows[name] for name in ("a", "still")}, (), auto=False)


def test_names_of_files_differ(tmp_path):
    assert names_of([tmp_path / "x.csv", tmp_path / "sub" / "x.csv"]) == ["x.csv", "x.csv (2)"]


def test_every_step_is_scored_on_another_recording_that_no_fit_used(found):
    base, step = (each.rmse_validation for each in found.steps)
    assert step < base
    assert step == pytest.approx(NOISE, rel=0.1)
    assert "validation" in "\n".join(together_lines(found))


def test_an_effect_that_another_recording_contradicts_is_suggested_at_most():
    windows = {"a": swinging(5.0, 1), "b": swinging(2.0, 2)}
    sound = swinging(2.0, 7, band=0.0)
    doubted = compared_together(benches(**windows), (), auto=True, validate=sound)
    assert [each.effects for each in doubted.steps] == [()]
    assert (doubted.verdict.kind, doubted.verdict.effect) == ("suggested", "deadband")
    assert WORSE_ELSEWHERE in doubted.verdict.lacks
    assert WORSE_ELSEWHERE in "\n".join(together_lines(doubted))


def test_the_page_has_the_verdict_each_recording_and_no_address(found):
    page = together_html(found)
    assert f'<p class="verdict">{capital(found.verdict_words)}.</p>' in page
    assert found.verdict.effect is None
    assert "+ deadband" in page
    assert page.count("<img ") == len(found.recordings)
    assert all(f"the models on {name}" in page for name in found.recordings)
    assert "://" not in page  # a colon: "http" alone may stand in the letters of a picture


def test_a_band_in_one_recording_only_is_not_confirmed_for_the_loop():
    mixed = compared_together(benches(a=swinging(5.0, 1), b=swinging(5.0, 2, 0.0)), (), auto=True)
    assert mixed.verdict.kind not in {"confirmed", "family"}
    assert [each.effects for each in mixed.steps] == [()]
