import numpy as np
import pytest
from scipy import signal

from agent.analysis.stiction.shapes.third_harmonic import third_harmonic

PERIOD = 41.3
PHASE = 2 * np.pi * np.arange(1500) / PERIOD
PARABOLAS = np.cumsum(signal.sawtooth(PHASE + np.pi / 2, 0.5))


def noisy(wave, noise):
    return signal.detrend(wave / np.std(wave) + noise * np.random.default_rng(0).normal(size=len(wave)))


@pytest.mark.parametrize(
    ("wave", "noise", "found"),
    [
        (np.sin(PHASE), 0.02, "absent"),
        (np.sin(PHASE), 0.15, "absent"),
        (np.sin(PHASE), 1.0, "hidden"),
        (PARABOLAS, 0.02, "seen"),
        (PARABOLAS, 1.0, "hidden"),
        (signal.sawtooth(PHASE, 0.5), 0.3, "seen"),
        (np.sign(np.sin(PHASE)), 0.5, "seen"),
    ],
)
def test_waves(wave, noise, found):
    assert third_harmonic(noisy(wave, noise), PERIOD) == found


def test_past_the_nyquist_frequency_it_is_hidden():
    for period in (5.0, 8.0):
        wave = noisy(np.sin(PHASE * PERIOD / period), 0.02)
        assert third_harmonic(wave, period) == "hidden"
