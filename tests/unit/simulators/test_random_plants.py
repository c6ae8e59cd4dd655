from typing import get_args

import numpy as np
import pytest

from simulators.periodicity import swing
from simulators.plant import simulate
from simulators.random_plants import PERIODS, SHAPES, STEADY, Kind, random_plant

CAUSES = {
    "stiction": "stiction",
    "none_noise": "no_oscillation",
    "tuning": "tight_tuning",
    "sinusoid": "external_disturbance",
    "drift": "no_oscillation",
}


@pytest.mark.parametrize("kind", get_args(Kind))
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_draw_keeps_the_promise_of_its_kind(kind, seed):
    scenario = random_plant(seed, kind)
    assert scenario.truth.cause == CAUSES[kind]
    record = simulate(scenario)
    assert len(record.pv) == 2000
    period, strength = swing(record.mv)
    if kind in {"stiction", "tuning", "sinusoid"}:
        assert strength >= STEADY
        assert PERIODS[0] <= period <= PERIODS[1]
    if kind in {"stiction", "sinusoid", "drift"}:
        quiet = simulate(scenario.model_copy(update={"noise": scenario.noise.model_copy(update={"std": 0})}))
        assert 0.01 < scenario.noise.std / np.std(quiet.pv) < 0.6


def test_draws_repeat_and_differ():
    assert random_plant(7, "sinusoid") == random_plant(7, "sinusoid")
    assert random_plant(7, "sinusoid") != random_plant(8, "sinusoid")


def test_all_shapes_of_stiction_and_both_laws_are_drawn():
    valves = [random_plant(seed, "stiction").valve for seed in range(10)]
    ratios = [(valve.f_s - valve.f_d) / (valve.f_s + valve.f_d) for valve in valves]
    for low, high in SHAPES:
        assert any(low <= ratio <= high for ratio in ratios)
    assert {valve.law for valve in valves} == {"karnopp", "lugre"}
