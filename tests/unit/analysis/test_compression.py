"""Straight lines of a historian are seen, raw and coarse records are not accused."""

import numpy as np
import pytest

from agent.analysis.record.compression import DESTROYS, compression_factor
from connectors.recording import read_recording

RNG = np.random.default_rng(5)
T = np.arange(1500)
RAW = 50 + 5 * np.sin(2 * np.pi * T / 80) + 0.2 * RNG.standard_normal(T.size)


@pytest.mark.parametrize("decimals", [2, 3, 4, 12])
@pytest.mark.parametrize("kept", [4, 8, 20])
def test_lines_between_kept_points_are_counted(kept, decimals):
    places = np.append(T[::kept], T[-1])
    lines = np.round(np.interp(T, places, RAW[places]), decimals)
    factor = compression_factor(lines)
    if factor is None:
        assert decimals == 2  # slopes of a few digits a sample
    else:
        assert factor == pytest.approx(kept, rel=0.5)
        assert factor > DESTROYS


@pytest.mark.parametrize("decimals", [1, 2, 4, 12])
def test_a_raw_record_is_raw(decimals):
    factor = compression_factor(np.round(RAW, decimals))
    assert factor is None or factor < 1.5


def test_gaps_and_standstill_are_no_lines():
    assert compression_factor(np.where(T % 7 == 0, np.nan, RAW)) < 1.5
    assert compression_factor(np.full(1500, 3.0)) is None
    assert compression_factor(np.full(1500, np.nan)) is None
    assert compression_factor(RAW[:20]) is None


def test_real_recordings_are_raw(recordings):
    factors = {}
    for file in sorted((recordings / "isdb").glob("*.csv")):
        factors[file.stem] = compression_factor(read_recording(file).pv)
    assert all(factor is None or factor < DESTROYS for factor in factors.values()), factors
