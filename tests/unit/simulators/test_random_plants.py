from typing import get_args

import numpy as np
import pytest

from simulators.draws import random_plants
from simulators.draws.periodicity import period_and_strength
from simulators.draws.random_plants import PERIODS, SHAPES, STEADY, Kind, random_draw, random_plant
from simulators.plant import simulate

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
    period, strength = period_and_strength(record.mv)
    if kind in {"stiction", "tuning", "sinusoid"}:
        assert strength >= STEADY
        assert PERIODS[0] <= period <= PERIODS[1]
    if kind in {"stiction", "sinusoid", "drift"}:
        quiet = simulate(scenario.model_copy(update={"noise": scenario.noise.model_copy(update={"std": 0})}))
        assert 0.01 < scenario.noise.std / np.std(quiet.pv) < 0.6


def test_draws_repeat_and_differ():
    assert random_plant(7, "none_noise") == random_plant(7, "none_noise")
    assert random_plant(7, "none_noise") != random_plant(8, "none_noise")


def test_all_shapes_of_stiction_and_both_laws_are_drawn(sticking_draws):
    valves = [draw.scenario.valve for draw in sticking_draws[:20]]
    ratios = [(valve.f_s - valve.f_d) / (valve.f_s + valve.f_d) for valve in valves]
    for low, high in SHAPES:
        assert any(low <= ratio <= high for ratio in ratios)
    assert {valve.law for valve in valves} == {"karnopp", "lugre"}


@pytest.fixture
def sticking_draws(monkeypatch):
    """200 draws as they are before any is thrown away, which spares their simulation."""
    still = type("Record", (), {"pv": np.array([-1.0, 1.0])})
    monkeypatch.setattr(random_plants, "simulate", lambda _scenario: still)
    monkeypatch.setattr(random_plants, "_keeps_promise", lambda *_: True)
    return [random_draw(seed, "stiction") for seed in range(200)]


def test_two_hundred_draws_fill_the_ranges_that_the_benchmark_speaks_of(sticking_draws):
    scenarios = [draw.scenario for draw in sticking_draws]
    processes = [scenario.process for scenario in scenarios]
    kinds = {kind: sum(each.kind == kind for each in processes) for kind in {each.kind for each in processes}}
    assert set(kinds) == {"first_order", "second_order", "integrating"}
    assert min(kinds.values()) >= 30
    spread(sticking_draws, "noise_share", 0.02, 0.3)
    assert sum(draw.noise_share > 0.15 for draw in sticking_draws) >= 30
    spread(processes, "delay", 0.5, 12)
    spread([each for each in processes if each.kind != "integrating"], "tau", 3, 30)
    gains = [each for each in processes if each.kind != "integrating"]
    assert min(abs(each.gain) for each in gains) < 0.7
    assert max(abs(each.gain) for each in gains) > 2.5
    assert {np.sign(each.gain) for each in processes} == {-1, 1}
    tunings = [scenario.peak_sensitivity for scenario in scenarios]
    assert min(tunings) < 1.4
    assert max(tunings) > 2
    for quantised in ("pv", "op"):
        share = np.mean([getattr(scenario.quantisation, quantised) > 0 for scenario in scenarios])
        assert 0.3 < share < 0.7
    assert 0.2 < np.mean([scenario.noise.correlation > 0 for scenario in scenarios]) < 0.5
    valves = [scenario.valve for scenario in scenarios]
    assert min(valve.f_s + valve.f_d for valve in valves) < 2
    assert max(valve.f_s + valve.f_d for valve in valves) > 10


def spread(parts, name, low, high):
    """Within the range, and in its lower and upper fifths on a log scale too."""
    values = np.array([getattr(part, name) for part in parts])
    fifth = (high / low) ** 0.2
    assert low <= values.min() < low * fifth
    assert high / fifth < values.max() <= high
