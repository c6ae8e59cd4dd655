"""What every oscillation detector must do, whatever it looks at."""

import math

import numpy as np
import pytest

from agent.analysis.oscillation import DETECTORS
from agent.analysis.record.recording import LoopWindow

N = 1000
T = np.arange(N)
NOISE = np.random.default_rng(11).normal(size=(2, N))
OP = 50 + 5 * np.sin(2 * np.pi * T / 60) + 0.2 * NOISE[0]
PV = 100 + 3 * np.sin(2 * np.pi * T / 60 - 1.5) + 0.2 * NOISE[1]

each = pytest.mark.parametrize("detector", DETECTORS, ids=lambda detector: detector.name)


def window(op=OP, pv=PV, ts=1.0):
    return LoopWindow("x", 0.0, ts, op=np.asarray(op, dtype=float), pv=np.asarray(pv, dtype=float))


def test_names_are_distinct():
    assert len({detector.name for detector in DETECTORS}) == len(DETECTORS)


@each
def test_it_sees_a_wave_and_its_period(detector):
    seen = detector.detect(window())
    assert seen.detected
    assert seen.period == pytest.approx(60, rel=0.02)


@each
@pytest.mark.parametrize(("scale", "offset"), [(1e-6, 0), (1e6, 0), (-2, 7), (1, 1e4)])
def test_units_and_offset_change_nothing(detector, scale, offset):
    one, other = detector.detect(window()), detector.detect(window(scale * OP + offset, scale * PV + offset))
    assert other.detected == one.detected
    assert other.period == pytest.approx(one.period, rel=1e-6)
    assert (other.regularity is None) == (one.regularity is None)
    assert (other.regularity or 0) == pytest.approx(one.regularity or 0, rel=1e-3)


@each
def test_the_period_is_in_seconds(detector):
    assert detector.detect(window(ts=20.0)).period == pytest.approx(1200, rel=0.02)


@each
def test_gaps_are_left_out(detector):
    lost = np.random.default_rng(3).random((2, N)) < 0.05
    seen = detector.detect(window(np.where(lost[0], np.nan, OP), np.where(lost[1], np.nan, PV)))
    for number in (seen.period, seen.regularity, seen.share):
        assert number is None or math.isfinite(number)


@each
@pytest.mark.parametrize("n", [0, 1, 2, 3, 5, 20])
def test_a_short_record_shows_nothing(detector, n):
    assert not detector.detect(window(OP[:n], PV[:n])).detected


@each
@pytest.mark.parametrize("flat", [np.zeros(N), np.full(N, 1e9), np.full(N, np.nan), 0.1 * T])
def test_what_does_not_move_does_not_oscillate(detector, flat):
    seen = detector.detect(window(flat, flat))
    assert (seen.detected, seen.period, seen.regularity) == (False, None, None)


@each
def test_its_input_stays_as_it_was(detector):
    seen = window()
    before = seen.op.copy(), seen.pv.copy()
    detector.detect(seen)
    np.testing.assert_array_equal(before, (seen.op, seen.pv))


@pytest.mark.parametrize(
    "detector", [each for each in DETECTORS if each.noise_proof], ids=lambda detector: detector.name
)
def test_one_that_says_so_is_not_deceived_by_noise(detector):
    """At most one in twenty records of white and slow noise, a walk and a drift with noise."""
    rng = np.random.default_rng(5)
    alarms = 0
    for _ in range(20):
        white = rng.normal(size=N)
        slow = np.convolve(rng.normal(size=N + 60), 0.95 ** np.arange(61), mode="valid")
        for values in (white, slow, np.cumsum(white), 0.02 * T + white):
            alarms += detector.detect(window(values, values)).detected
    assert alarms <= 4
