import numpy as np
import pytest

from simulators.disturbance import FirstOrderNoise, Load, strength_of
from simulators.parameters import Bursts, Drift, LoadStepParameters, SinusoidParameters, Wander

IN_BURSTS = Bursts(std=0.5, correlation=10.0)


def load(sinusoid=None, drift=None, steps=(), wander=None, bursts=None, n=2000):
    rng = np.random.default_rng(1)
    wave, drift, wander = sinusoid or SinusoidParameters(), drift or Drift(), wander or Wander()
    source = Load(wave, drift, steps, wander, bursts or Bursts(), 1.0, rng)
    return np.array([source.over(float(t)) for t in range(n)])


def test_no_disturbance_is_no_load():
    assert not load().any()


def test_sinusoid_has_its_amplitude_and_period():
    values = load(SinusoidParameters(amplitude=3.0, period=50.0))
    assert values.max() == pytest.approx(3.0, abs=0.01)
    assert np.argmax(np.abs(np.fft.rfft(values))) == 2000 / 50


def test_ramp_and_walk():
    assert load(drift=Drift(ramp=-0.01))[1000] == pytest.approx(-10)
    steps = np.diff(load(drift=Drift(walk=0.2), n=5000))
    assert steps.std() == pytest.approx(0.2, rel=0.05)


def test_steps_stand_in_place_of_each_other():
    values = load(
        steps=(LoadStepParameters(time=10.0, load=2.0), LoadStepParameters(time=20.0, load=-1.0)), n=30
    )
    assert values == pytest.approx(np.repeat([0.0, 2.0, -1.0], 10))


def test_wander_stays_about_zero_with_its_memory():
    values = load(wander=Wander(std=2.0, correlation=10.0), n=20_000)
    assert values.std() == pytest.approx(2.0, rel=0.1)
    assert np.corrcoef(values[10:], values[:-10])[0, 1] == pytest.approx(np.exp(-1), abs=0.06)


@pytest.mark.parametrize("correlation", [0.0, 3.0])
def test_noise_has_its_deviation_and_memory(correlation):
    noise = FirstOrderNoise(0.5, correlation, 1.0, np.random.default_rng(2))
    values = np.array([noise.next() for _ in range(20_000)])
    assert values.std() == pytest.approx(0.5, rel=0.05)
    expected = np.exp(-1 / correlation) if correlation else 0.0
    assert np.corrcoef(values[1:], values[:-1])[0, 1] == pytest.approx(expected, abs=0.03)


def in_bursts(values):
    """Whether sizes go along with those of a moment ago, and far ones are more than Gaussian noise has."""
    sizes = np.abs(values) - np.mean(np.abs(values))
    together = np.mean(sizes[3:] * sizes[:-3]) / np.mean(sizes**2)
    return together > 0.1 and np.mean(values**4) / np.mean(values**2) ** 2 > 4.0


def test_a_walk_and_noise_in_bursts_are_as_large_as_without():
    steps = np.diff(load(drift=Drift(walk=0.2), bursts=IN_BURSTS, n=20_000))
    assert steps.std() == pytest.approx(0.2, rel=0.1)
    assert in_bursts(steps)
    assert not in_bursts(np.diff(load(drift=Drift(walk=0.2), n=20_000)))
    rng = np.random.default_rng(2)
    noise = FirstOrderNoise(0.5, 0.0, 1.0, rng, strength_of(IN_BURSTS, 1.0, rng))
    values = np.array([noise.next() for _ in range(20_000)])
    assert values.std() == pytest.approx(0.5, rel=0.1)
    assert in_bursts(values)
    assert load(wander=Wander(std=2.0), bursts=IN_BURSTS, n=20_000).std() == pytest.approx(2.0, rel=0.15)


def test_without_bursts_nothing_else_is_drawn():
    assert strength_of(Bursts(), 1.0, np.random.default_rng(0)) is None
