"""Each loop has the effect that its name says, and its floor is the rest without it."""

import numpy as np
import pytest

from simulators.draws.effect_draws import HIDE, SETTLING
from simulators.draws.hidden_effects import NOTHING, SAMPLES, TRUTHS, hidden_effect_plant
from simulators.field import response
from simulators.parameters import Drift, Noise, Quantisation, ValveParameters, Wander


@pytest.mark.parametrize("truth", TRUTHS)
def test_draw_has_its_effect_and_repeats(truth):
    plant = hidden_effect_plant(100, truth)
    again = hidden_effect_plant(100, truth)
    assert np.array_equal(plant.pv, again.pv)
    assert SAMPLES[0] <= len(plant.op) <= SAMPLES[1]
    assert 0 < plant.op.min() < plant.op.max() < 100
    assert len(np.unique(plant.sp)) > 5
    assert set(plant.effects) == set(
        truth.split("_") if truth == "stiction_sinusoid" else {truth} - set(NOTHING)
    )
    for name, values in plant.parameters.items():
        assert name.split(".")[0] in plant.effects
        assert min(values) > 0


@pytest.mark.parametrize("truth", NOTHING)
def test_a_loop_with_nothing_hidden_has_a_plain_field(truth):
    """What is no effect is in the floor alone: without it the field is linear and at rest."""
    scenario = hidden_effect_plant(101, truth).scenario
    plain = scenario.model_copy(
        update={"noise": Noise(), "drift": Drift(), "wander": Wander(), "quantisation": Quantisation()}
    )
    step = np.full(400, scenario.controller.op)
    assert response(plain, step) == pytest.approx(scenario.controller.sp)
    up, down = (response(plain, step + move) - scenario.controller.sp for move in (3.0, -6.0))
    assert down == pytest.approx(-2 * up, abs=1e-9)
    assert scenario.valve == ValveParameters(damping=scenario.valve.damping)


@pytest.mark.parametrize("truth", ["none", "deadband"])
def test_the_floor_knows_nothing_of_the_set_point(truth):
    plants = [hidden_effect_plant(seed, truth) for seed in range(100, 108)]
    alike = [np.corrcoef(plant.floor, plant.sp)[0, 1] for plant in plants]
    assert abs(np.mean(alike)) < 0.15
    for plant in plants:
        assert plant.scenario.noise.std < plant.floor.std() < plant.pv.std()
        assert plant.scenario.duration == SETTLING + len(plant.op)


def test_each_effect_can_be_hidden_alone():
    assert set(HIDE) == set(TRUTHS) - set(NOTHING) - {"stiction_sinusoid"}
    assert hidden_effect_plant(103, "stiction_sinusoid").effects == ("stiction", "sinusoid")
