"""A load of edges has as many harmonics as the record needs, also when its model is loaded again."""

from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.physics.effects.wave import HARMONICS, RepeatingWave
from agent.report.comparison_text import comparison_lines
from agent.workbench.session import Workbench
from agent.workbench.solved.more_harmonics import with_more_harmonics
from simulators.draws.open_records import open_record

OTHERS = {each.family for each in EFFECTS} - {"disturbance"}


def wave_of_fit(fitted):
    return next(each for each in fitted.model.effects if isinstance(each, RepeatingWave))


def wave_of(step):
    return wave_of_fit(step.fit)


def window_of(shape):
    """A record in manual behind a fast process, with a load of this shape."""
    record = open_record(91111, "steps", "none")
    phase = np.arange(len(record.op)) / 90.0
    load = np.sign(np.sin(2 * np.pi * phase)) if shape == "edges" else np.sin(2 * np.pi * phase)
    return LoopWindow(shape, 0.0, 1.0, record.op, record.pv + 0.3 * np.ptp(record.pv) * load)


@pytest.fixture(scope="module")
def edges():
    bench = Workbench(window_of("edges"), without=OTHERS)
    bench.add("wave")
    return bench


def test_a_load_of_edges_has_more_harmonics_than_the_search(edges):
    assert wave_of(edges.step).harmonics > HARMONICS


def test_a_load_that_is_a_sinusoid_has_no_more():
    bench = Workbench(window_of("sinusoid"), without=OTHERS)
    bench.add("wave")
    assert wave_of(bench.step).harmonics == HARMONICS


def test_a_model_that_is_loaded_has_them_again(edges):
    again = Workbench(window_of("edges"), without=OTHERS)
    again.load(edges.save())
    assert wave_of(again.step) == wave_of(edges.step)
    assert again.step.held_out.rmse == pytest.approx(edges.step.held_out.rmse, rel=1e-3)


def test_a_wave_that_is_too_fast_for_its_harmonics_or_a_model_without_one_gets_none(edges):
    base, fitted = edges.staircase()[0].fit, edges.step.fit
    assert with_more_harmonics(base, edges.record) is None
    fast = replace(fitted, values=np.concatenate((fitted.values[:-1], [0.06])))
    assert with_more_harmonics(fast, edges.record) is None


def test_the_harmonics_of_a_slow_wave_end_at_five_samples(edges):
    fitted, numbers = edges.step.fit, [HARMONICS]
    slow = replace(fitted, values=np.concatenate((fitted.values[:-1], [1 / 300.0])))
    while slow is not None:
        numbers.append(wave_of_fit(slow).harmonics)
        found = with_more_harmonics(slow, edges.record)
        slow = None if found is None else replace(found, values=slow.values)
    assert max(numbers) / 300.0 <= 0.2 / edges.record.facts.ts < 2 * max(numbers) / 300.0


@pytest.mark.parametrize(("seed", "kind"), [(91580, "bump"), (91605, "prbs")])
def test_a_sawtooth_is_confirmed_and_no_steps_in_its_place(seed, kind):
    """Behind an autoregression three harmonics gain nothing, and three steps are as likely as all of them."""
    record = open_record(seed, kind, "wave")
    verdict = Workbench(LoopWindow("saw", 0.0, record.scenario.ts, record.op, record.pv)).comparison().verdict
    assert (verdict.kind, verdict.effect) == ("confirmed", "wave")


def test_the_report_shows_the_first_harmonics_of_many(edges):
    lines = [*comparison_lines(edges.comparison())]
    assert any(line.startswith("  wave.amplitude_3 ") for line in lines)
    assert not any(line.startswith("  wave.amplitude_4 ") for line in lines)
    most = wave_of(edges.step).harmonics
    assert f"  amplitudes and phases of harmonics 4 to {most}: --json has them" in lines
