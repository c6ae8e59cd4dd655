"""Lines of a residual: the loop's own, or from outside."""

import numpy as np
import pytest
from scipy import signal

from agent.workbench.residual.line_spectrum import cycles_of, line_spectrum

N = 2000


def wandering(rng, spread=0.12):
    """Cycles made by an oscillation whose period changes from cycle to cycle, (n,)."""
    periods = 60 * np.exp(spread * rng.normal(size=60))
    return np.interp(np.arange(N), np.concatenate(([0.0], np.cumsum(periods))), np.arange(61.0))


def triangle(cycles):
    return 5 * signal.sawtooth(2 * np.pi * cycles, 0.5)


def kinds(found):
    return {(line.harmonic, line.kind) for line in found.lines}


def test_cycles_count_from_low_to_low():
    cycles = cycles_of(triangle(np.arange(N) / 50))
    known = np.isfinite(cycles)
    assert np.nanmax(cycles) == pytest.approx(N / 50, abs=2.1)
    np.testing.assert_allclose(np.diff(cycles[known]), 1 / 50, rtol=0.1)
    assert np.isnan(cycles_of(np.arange(N, dtype=float))).all()


def test_harmonics_that_follow_op_are_locked():
    rng = np.random.default_rng(1)
    cycles = wandering(rng)
    residual = signal.square(2 * np.pi * cycles + 0.7) + 0.2 * rng.normal(size=N)
    assert {(1, "locked"), (3, "locked")} <= kinds(line_spectrum(residual, triangle(cycles), 1.0))


def test_a_wave_of_its_own_time_is_from_outside():
    rng = np.random.default_rng(2)
    op = triangle(wandering(rng))
    for frequency in (1 / 60, 1 / 41):  # at the mean frequency of OP, and between its harmonics
        residual = np.sin(2 * np.pi * frequency * np.arange(N)) + 0.3 * rng.normal(size=N)
        (line,) = line_spectrum(residual, op, 2.0).lines
        assert line.kind == "coherent"
        assert line.frequency == pytest.approx(frequency / 2.0, rel=0.02)


def test_an_even_cycle_cannot_be_distinguished_from_outside():
    rng = np.random.default_rng(3)
    cycles = np.arange(N) / 60
    residual = np.sin(2 * np.pi * cycles) + 0.3 * rng.normal(size=N)
    assert kinds(line_spectrum(residual, triangle(cycles), 1.0)) == {(1, "either")}


def test_noise_of_any_colour_has_hardly_a_line():
    for pole in (0.0, 0.9, 0.97):
        with_lines = 0
        for seed in range(60):
            rng = np.random.default_rng(seed)
            residual = signal.lfilter([1.0], [1.0, -pole], rng.normal(size=N))
            with_lines += bool(line_spectrum(residual, triangle(wandering(rng)), 1.0).lines)
        assert with_lines <= 4


def test_gaps_and_what_has_no_spectrum():
    rng = np.random.default_rng(4)
    residual = np.sin(np.arange(N) / 7) + 0.3 * rng.normal(size=N)
    residual[500:560] = np.nan
    assert len(line_spectrum(residual, triangle(wandering(rng)), 1.0).lines) == 1
    assert line_spectrum(np.zeros(N), np.zeros(N), 1.0) is None
    assert line_spectrum(np.full(N, np.nan), np.zeros(N), 1.0) is None


def test_a_slow_wave_is_certain_where_it_is_most_of_what_is_slow():
    """White noise says nothing against it, slow noise does, which makes such lines by itself."""
    rng = np.random.default_rng(5)
    op, noise = triangle(wandering(rng)), rng.normal(size=N)
    wave, slow = np.sin(2 * np.pi * 9 * np.arange(N) / N), signal.lfilter([1.0], [1.0, -0.99], noise)
    for height, noisy, certain in ((3.0, noise, True), (12.0, slow, False), (40.0, slow, True)):
        found = line_spectrum(height * wave + noisy, op, 1.0)
        assert [round(line.frequency * N) for line in found.lines] == [9]
        assert bool(found.certain) == certain


def test_the_begin_of_a_record_is_no_low_though_op_rises_from_there():
    """A third harmonic of seven cycles, the first of them cut: with a low at its begin it was no harmonic."""
    at = np.arange(930.0)
    op = np.sin(2 * np.pi * (at / 156 + 0.1))
    counted = cycles_of(op)
    lows = np.flatnonzero(np.isfinite(counted))
    assert lows[0] == pytest.approx(156 * 0.65, abs=1)
    assert (counted[lows[-1]] - counted[lows[0]]) / (lows[-1] - lows[0]) == pytest.approx(1 / 156, rel=0.01)
    residual = np.sin(6 * np.pi * (at / 156 + 0.1)) + 0.05 * np.random.default_rng(0).normal(size=at.size)
    assert [each.harmonic for each in line_spectrum(residual, op, 1.0).lines] == [3]
