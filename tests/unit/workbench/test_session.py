import json

import numpy as np
import pytest
from loops import S, made, moves, slack

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.physics.effects.hysteresis import S_BY_LAW
from agent.report.comparison_json import comparison_json
from agent.report.comparison_text import comparison_lines, verdict_words
from agent.workbench.comparison import not_testable
from agent.workbench.session import Workbench
from agent.workbench.step import Verdict
from agent.workbench.verdict import ran_out

pytestmark = pytest.mark.timeout(240)  # a cold cache of kernels takes a minute
FEW = tuple(each.name for each in EFFECTS if each.name not in {"deadband", "sensor_lag", "load_step"})


@pytest.fixture(scope="module")
def bench():
    bench = Workbench(slack(), without=FEW, validate=slack(seed=5))
    bench.auto()
    return bench


def test_it_names_the_slack_and_the_error_falls_to_the_noise(bench):
    base, last = bench.staircase()
    assert (base.added, last.added) == (None, "deadband")
    assert last.verdict.kind == "confirmed"
    assert last.held_out.rmse < 0.3 * base.held_out.rmse
    assert last.held_out.rmse == pytest.approx(0.05, rel=0.2)
    assert last.rmse_validation == pytest.approx(0.05, rel=0.2)
    assert bench.comparison().verdict.kind == "no_failure_visible"


def test_the_slack_is_reported(bench):
    """How often intervals hold the truth: test_predictor.py, over ten records; here is one of them."""
    band = next(each for each in bench.step.parameters if each.name == "deadband.s")
    assert band.value == pytest.approx(S, abs=0.05)
    assert band.low < band.value < band.high
    # The record tells more than the law of friction leaves open.
    assert band.high - band.low == pytest.approx(2 * S_BY_LAW * band.value, rel=0.01)
    assert band.unit == "OP"


def test_the_json_has_every_key_and_no_nan(bench):
    found = json.loads(json.dumps(comparison_json(bench.comparison(), "made.csv"), allow_nan=False))
    assert found["recording"] == "made.csv"
    assert [step["effects"] for step in found["steps"]] == [[], ["deadband"]]
    assert set(found["steps"][1]["parameters"]) == {
        "delay",
        "gain",
        "tau",
        *(f"deadband.{each}" for each in ("s", "start", "damping")),
    }
    assert found["steps"][0]["verdict"] is None
    assert found["verdict"] == {
        "kind": "no_failure_visible",
        "effect": None,
        "family": None,
        "indistinguishable": [],
        "at_bound": [],
        "lacks": [],
    }
    assert {each["effect"] for each in found["candidates"]} == {"load_step"}  # the best first fit, by chance
    assert {"axis", "share", "p"} == set(found["where_it_fails"][0])
    assert found["noise_floor"]["low"] <= found["noise_floor"]["high"]


def test_the_text_says_it_in_words(bench):
    lines = list(comparison_lines(bench.comparison()))
    assert any("+ deadband" in line for line in lines)
    assert lines[-1].startswith("verdict: no failure is visible")


def test_compare_splits_the_model_into_what_each_effect_adds(bench):
    parts = bench.compare()
    assert set(parts) == {"model", "base", "deadband"}
    assert all(len(each) == len(bench.window) for each in parts.values())


def test_drop_undo_save_and_load(bench):
    saved = json.loads(json.dumps(bench.save()))
    again = Workbench(slack(), without=FEW)
    again.load(saved)
    assert again.step.effects == ("deadband",)
    assert again.step.rmse_fit == pytest.approx(bench.step.rmse_fit, rel=0.01)
    assert again.drop("deadband").effects == ()
    assert again.step.rmse_fit == pytest.approx(again.staircase()[0].rmse_fit, rel=0.01)
    assert again.undo().effects == ("deadband",)
    again.undo()
    with pytest.raises(ValueError, match="no step to undo"):
        again.undo()
    with pytest.raises(ValueError, match="of the loop made, not of other"):
        Workbench(made(loop="other")).load(saved)
    with pytest.raises(ValueError, match="no saved model"):
        again.load({"kind": "shopping list"})


def test_what_cannot_be_added_or_dropped_is_reported(bench):
    with pytest.raises(ValueError, match=r"no effect 'slip'; there are .*deadband"):
        bench.add("slip")
    with pytest.raises(ValueError, match="cannot be added to a model with deadband"):
        bench.add("stiction")
    with pytest.raises(ValueError, match="the model has no sinusoid"):
        bench.drop("sinusoid")
    with pytest.raises(ValueError, match="no effect or family 'fairies'"):
        Workbench(slack(), without=["fairies"])
    with pytest.raises(ValueError, match="no base 'third'"):
        Workbench(slack(), base="third")


def test_with_its_family_taken_out_it_does_not_name_another():
    told = []
    bench = Workbench(
        slack(),
        without=[*FEW, "deadband", "load_step"],
        progress=lambda what, *_: told.append(what),
    )
    bench.auto()
    assert bench.comparison().verdict.kind in {"none_of_the_known", "suggested"}
    assert bench.step.effects == ()
    assert "sensor_lag" in told


def test_nothing_is_missing_where_nothing_is():
    bench = Workbench(made(), without=FEW)
    bench.auto()
    assert bench.comparison().verdict.kind == "no_failure_visible"
    assert bench.step.effects == ()


def test_a_wave_that_nothing_known_explains_is_a_failure():
    window = made()
    wave = 0.15 * np.sin(2 * np.pi * 0.041 * np.arange(len(window)))
    bench = Workbench(
        LoopWindow("wave", 0.0, 1.0, window.op, window.pv + wave), without=[*FEW, "load_step", "deadband"]
    )
    found = bench.comparison()
    assert found.verdict.kind == "none_of_the_known"
    assert found.lines[0].frequency == pytest.approx(0.041, rel=0.01)
    assert found.where_it_fails[0].p > 0.05  # no axis shows it
    assert list(comparison_lines(found))[-1].startswith(
        "verdict: something is missing that none of the known effects explains: a wave of 24"
    )


def test_a_record_that_reports_nothing_has_a_reason_and_all_keys():
    still = LoopWindow("still", 0.0, 1.0, np.full(500, 50.0), np.random.default_rng(0).standard_normal(500))
    bench = Workbench(still)
    assert bench.auto() == ()
    found = comparison_json(bench.comparison(), bench.window.loop)
    assert found["verdict"]["kind"] == "not_testable"
    assert found["steps"] == found["candidates"] == found["where_it_fails"] == []
    assert found["noise_floor"] == {"low": None, "high": None}
    assert "OP does not move" in found["reason"]
    assert "not testable" in next(iter(comparison_lines(bench.comparison())))
    for ask in (lambda: bench.add("deadband"), bench.candidates, bench.where_it_fails, bench.save):
        with pytest.raises(ValueError, match="cannot be tested: OP does not move"):
            ask()


def test_a_process_that_integrates_is_none_of_the_known_where_none_may():
    op = moves()
    pv = np.cumsum(op - op.mean()) * 0.05 + 0.02 * np.random.default_rng(1).standard_normal(len(op))
    bench = Workbench(LoopWindow("level", 0.0, 1.0, op, pv), without=(*FEW, "deadband", "load_step"))
    assert ran_out(bench.step, bench.record.facts) == ("tau",)
    assert bench.comparison().verdict.kind == "none_of_the_known"
    assert ran_out(Workbench(made(), without=FEW).step, bench.record.facts) == ()


@pytest.mark.parametrize(
    ("told", "words"),
    [(("tau",), "tau ran into the bound"), ((), "a wave in step with OP is left")],
)
def test_a_failure_on_no_axis_is_reported_in_words(told, words):
    verdict = Verdict("none_of_the_known", at_bound=told)
    assert words in verdict_words(verdict, not_testable("loop", ""))


def test_a_verdict_names_effects_in_words():
    verdict = Verdict("suggested", "load_step", "disturbance", ("sensor_deadband",), ("load_step.tau",))
    words = verdict_words(verdict, not_testable("loop", ""))
    assert words == (
        "perhaps load step is missing, but that is not certain; sensor deadband would explain it as well; "
        "tau of load step ran into the bound of its search"
    )
