"""A load of edges has as many harmonics as the record needs, also when its model is loaded again."""

from dataclasses import replace
from itertools import pairwise

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


def test_the_frequency_of_edges_is_known_to_a_sample_in_the_record(edges):
    (frequency,) = (each for each in edges.step.parameters if each.name == "wave.frequency")
    a_sample = frequency.value * edges.record.facts.ts / edges.record.facts.duration
    assert frequency.low <= frequency.value - 0.99 * a_sample
    assert frequency.high >= frequency.value + 0.99 * a_sample


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
    assert with_more_harmonics(base, edges.record) == []
    fast = replace(fitted, values=np.concatenate((fitted.values[:-1], [0.06])))
    assert with_more_harmonics(fast, edges.record) == []


def test_the_harmonics_of_a_slow_wave_end_at_five_samples(edges):
    fitted, facts = edges.step.fit, edges.record.facts
    slow = replace(fitted, values=np.concatenate((fitted.values[:-1], [1 / 300.0])))
    numbers = [wave_of_fit(each).harmonics for each in with_more_harmonics(slow, edges.record)]
    assert 1 < 0.2 / facts.ts / (numbers[-1] / 300.0) < 1.2  # the frequency may move by half a line
    assert all(2 * one >= other > one for one, other in pairwise([wave_of(edges.step).harmonics, *numbers]))


def test_short_pulses_have_all_harmonics_though_the_next_gain_nothing():
    """The record is less likely with 6 and 12 harmonics than with 3, far likelier with 28 (decision 134)."""
    record = open_record(91111, "steps", "none")
    load = np.arange(len(record.op)) / 140.0 % 1 < 0.1
    bench = Workbench(
        LoopWindow("pulses", 0.0, 1.0, record.op, record.pv + np.ptp(record.pv) * load), without=OTHERS
    )
    bench.add("wave")
    assert wave_of(bench.step).harmonics > 20


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
