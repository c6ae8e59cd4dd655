"""Single wild scans are found; slips, steps, noise, kicks and levels that last are not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.analysis.record.wild_samples import wild
from connectors.recording import read_recording

RNG = np.random.default_rng(11)
T = np.arange(1200)
SQUARE = 50 + 4 * np.sign(np.sin(2 * np.pi * T / 90)) + 0.3 * RNG.standard_normal(T.size)
SMOOTH = 50 + 5 * np.sin(2 * np.pi * T / 60) + 0.1 * RNG.standard_normal(T.size)
STAIR = np.round(50 + np.cumsum(RNG.choice([0, 0, 0, 0.5, -0.5], T.size)), 1)


@pytest.mark.parametrize("signal", [SQUARE, SMOOTH, STAIR], ids=["square", "smooth", "stair"])
@pytest.mark.parametrize("value", [1e6, -999.0, 0.0, 65535.0, 1e12])
@pytest.mark.parametrize("places", [(100,), (0, 500, 1199), (300, 301, 800)])
def test_single_wild_scans_are_found_and_nothing_else(signal, value, places):
    spoilt = signal.copy()
    spoilt[list(places)] = value
    if abs(value - signal.mean()) <= 2.2 * np.ptp(signal):
        pytest.skip("within reach of this signal")
    np.testing.assert_array_equal(np.flatnonzero(wild(spoilt)), places)


@pytest.mark.parametrize(
    "signal", [SQUARE, SMOOTH, STAIR, np.where(T < 600, 40.0, 60.0), np.full(T.size, 3.0)]
)
def test_a_signal_of_a_plant_has_none(signal):
    assert not wild(signal).any()


def test_a_level_that_lasts_and_a_signal_of_pulses_are_no_single_events():
    lasting = SMOOTH.copy()
    lasting[400:410] = 500.0
    assert not wild(lasting).any()
    pulses = SMOOTH.copy()
    pulses[::20] = 500.0
    assert not wild(pulses).any()


def test_gaps_and_short_records_are_taken_as_they_are():
    gappy = SMOOTH.copy()
    gappy[::3] = np.nan
    gappy[100] = -999.0
    np.testing.assert_array_equal(np.flatnonzero(wild(gappy)), [100])
    assert not wild(np.full(50, np.nan)).any()
    assert not wild(np.array([1.0, 2.0, 900.0])).any()


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 1_000_000), st.floats(1e-3, 1e3))
def test_noise_is_not_wild_whatever_its_size(seed, size):
    noise = size * np.random.default_rng(seed).standard_normal(400)
    assert not wild(noise).any()


def test_real_recordings_have_next_to_none(recordings):
    found = {}
    for folder in ("isdb", "refinery"):
        for file in sorted((recordings / folder).glob("*.csv")):
            loop = read_recording(file)
            found[file.stem] = int(wild(loop.op).sum() + wild(loop.pv).sum())
    assert sum(found.values()) == 0, {name: count for name, count in found.items() if count}


def test_a_scan_within_the_range_of_the_record_is_wild_too():
    starting = SMOOTH * (1 - np.exp(-T / 15.0))  # begins at 0
    wide = 50 + 20 * np.sin(2 * np.pi * T / 60) + 0.1 * RNG.standard_normal(T.size)
    for signal in (starting, wide):
        spoilt = signal.copy()
        spoilt[[300, 700, 701, 1000]] = 0.0
        np.testing.assert_array_equal(np.flatnonzero(wild(spoilt)), [300, 700, 701, 1000])


def test_a_level_that_ends_as_the_record_begins_is_none():
    signal = SQUARE.copy()
    signal[:2], signal[-1] = 46.0, 46.0
    signal[2:20], signal[-20:-1] = 54.0, 54.0
    assert not wild(signal).any()
