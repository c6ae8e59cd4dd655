"""The next test is computed from two models: short where they differ much, none where they are one."""

from dataclasses import replace

import numpy as np
import pytest
from loops import DELAY, GAIN, STEM, TAU, S, made

from agent.physics.bases import Fopdt
from agent.physics.effects.actuator_lag import ActuatorLag
from agent.physics.effects.deadband import Deadband
from agent.physics.effects.sensor_deadband import SensorDeadband
from agent.physics.effects.sensor_lag import SensorLag
from agent.physics.effects.sinusoid import Sinusoid
from agent.physics.loop_model import LoopModel
from agent.plots.workbench.next_test import next_test_figure
from agent.workbench.design.next_test import NEEDED, next_test
from agent.workbench.design.plans import Plan
from agent.workbench.fit import fit, fit_at
from agent.workbench.hooks import silent
from agent.workbench.inputs.measured_input import MeasuredInput
from agent.workbench.projection import target_of
from agent.workbench.session.opening import opened
from agent.workbench.step import Verdict, step_of
from agent.workbench.trial import Tried

BAND = Deadband(), (S, 0.0, STEM)


@pytest.fixture(scope="module")
def plain():
    """A record of a plain process and its base, fitted."""
    return opening(made(noise=0.4))


def opening(window):
    trials, alone = opened(window, Fopdt(), map, silent)
    return trials.record, alone


def planned(plain, first, second):
    """The test for two effects with these values, each with the true process."""
    record, alone = plain
    models = {}
    for effect, own in (first, second):
        model = LoopModel(Fopdt(), (effect,))
        target = target_of(record, record.weight, linear=True)
        fitted = fit_at(model, record, target, np.array([DELAY, TAU, *own]))
        models[effect.name] = Tried(fitted, alone.predicts, alone.held_out)
    verdict = Verdict("suggested", first[0].name, "", (second[0].name,))
    return next_test(step_of(alone, record, None), verdict, models)


def test_a_measured_input_is_held_in_a_test_that_is_as_long_as_the_test_needs(plain):
    feed = np.sin(0.05 * np.arange(len(plain[0])))
    found = planned(plain, BAND, (MeasuredInput("FEED", feed), (5.0, 10.0)))
    assert len(found.plan.op) != len(feed)
    assert found.difference >= NEEDED
    assert found.words.endswith("; hold FEED still meanwhile")
    without = planned(plain, BAND, (SensorLag(), (0.5,)))
    assert "still meanwhile" not in without.words
    # Held, it is nothing but a level: what it would measure is what the process alone does.
    _, second = found.predicted
    process = LoopModel(Fopdt(), ())
    alone = fit_at(
        process, plain[0], target_of(plain[0], plain[0].weight, linear=True), np.array([DELAY, TAU])
    )
    response = process.columns(found.plan.op, alone.values, plain[0].facts)[:, 0]
    assert np.corrcoef(GAIN * response, second)[0, 1] == pytest.approx(1.0, abs=1e-6)


def test_bands_before_and_behind_the_lag_are_distinguished_by_a_move_and_back(plain):
    found = planned(plain, BAND, (SensorDeadband(), (S, 0.0)))
    assert found.difference >= NEEDED
    assert found.plan.kind in {"bump", "back_in_steps", "staircase"}
    assert np.ptp(found.plan.op) == pytest.approx(found.plan.size)
    assert found.words.startswith("to distinguish deadband from sensor deadband: in manual, hold OP at ")
    figure = next_test_figure("made", found)
    assert [each.get_label() for each in figure.axes[1].lines] == [
        "PV with deadband",
        "PV with sensor_deadband",
    ]


def test_a_wave_and_a_band_are_distinguished_by_an_op_that_stands(plain):
    found = planned(plain, (Sinusoid(), (0.021,)), BAND)
    assert found.difference >= NEEDED
    still = np.full(len(found.plan.op), 50.0)
    assert "keep OP at 50 for" in replace(found, plan=Plan("still", 0.0, 9, still)).words


def test_a_wider_band_needs_no_longer_a_test(plain):
    small, large = (
        planned(plain, (Deadband(), (s, 0.0, STEM)), (SensorDeadband(), (s, 0.0))) for s in (0.5, 5.0)
    )
    assert large.repeats * len(large.plan.op) < small.repeats * len(small.plan.op)


def test_no_test_distinguishes_a_lag_before_the_process_from_one_behind_it():
    record, alone = opening(made((ActuatorLag(),), (6.0,), noise=0.4))
    models = {}
    for effect in (ActuatorLag(), SensorLag()):
        found = fit(LoopModel(Fopdt(), (effect,)), record, record.weight, np.array([[DELAY, TAU, 6.0]]))
        models[effect.name] = Tried(found, alone.predicts, alone.held_out)
    verdict = Verdict("family", "actuator_lag", "extra_lag", ("sensor_lag",))
    found = next_test(step_of(alone, record, None), verdict, models)
    assert found.plan is None
    assert "measure the valve's position" in found.words
    assert next_test_figure("made", found) is None
