"""What the stem does beside OP: Kano A and B and Yamashita, on strokes made by hand and simulated loops."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

from agent.analysis.record.recording import LoopHints
from agent.analysis.results import Oscillation
from agent.analysis.stiction.kano_a import KanoA
from agent.analysis.stiction.kano_b import KanoB
from agent.analysis.stiction.shapes.stem import Stem, stem_of, time_of_half_the_way
from agent.analysis.stiction.shapes.stuck import standing
from agent.analysis.stiction.yamashita import Yamashita, qualitative_shape
from agent.physics.valves.he2007 import He2007
from agent.units import FrictionBands
from tests.unit.stiction.loops import detect, simulated

PERIOD = 100.0
TRIANGLE = 10 * signal.sawtooth(2 * np.pi * np.arange(2000) / PERIOD, 0.5)
BANDS = FrictionBands.from_s_j(6.0, 4.0)
STUCK = He2007().position(TRIANGLE, BANDS, 0.0)
SINE = 3 * np.sin(2 * np.pi * np.arange(2000) / PERIOD)
ONE_SLIP = 0.315 * TRIANGLE
ONE_SLIP_STUCK = He2007().position(ONE_SLIP, BANDS, -BANDS.j / 2)
NOISE = 0.1 * np.random.default_rng(0).normal(size=2000)
ALL = pytest.mark.parametrize("detector", [KanoA(), KanoB(), Yamashita()], ids=lambda each: each.name)


@ALL
@pytest.mark.parametrize("late", [0, 1])
def test_a_measured_stem(detector, late):
    for noise in (0.0, 1.0):
        stuck = np.roll(ONE_SLIP_STUCK, late) + noise * NOISE
        free = np.roll(SINE, late) + noise * NOISE
        assert detect(detector, ONE_SLIP, ONE_SLIP, PERIOD, mv=stuck).verdict == "stiction"
        assert detect(detector, SINE, SINE, PERIOD, mv=free).verdict == "no_stiction"


@ALL
def test_many_slips_a_stroke_are_never_a_free_stem(detector):
    assert detect(detector, TRIANGLE, TRIANGLE, PERIOD, mv=STUCK).verdict in ("stiction", "not_applicable")


@ALL
def test_a_free_stem_follows_the_noise_of_op(detector):
    op = TRIANGLE + 20 * NOISE
    assert detect(detector, op, op, PERIOD, mv=np.roll(op, 1)).verdict == "no_stiction"


def test_one_slip_a_stroke_gives_s_and_j_back():
    for noise in (0.0, 1.0):
        seen = detect(KanoB(), ONE_SLIP, ONE_SLIP, PERIOD, mv=ONE_SLIP_STUCK + noise * NOISE).seen
        assert seen.s == pytest.approx(BANDS.s, rel=0.1)
        assert seen.j == pytest.approx(BANDS.j, rel=0.1)
        assert len(seen.sides) == pytest.approx(2 * len(ONE_SLIP) / PERIOD, abs=2)


@pytest.mark.parametrize("seed", [1, 3, 8, 13])
def test_kano_b_finds_the_stick_band_of_a_simulated_valve(seed):
    window, oscillation, scenario = simulated("stiction", seed)
    result = KanoB().detect(window, oscillation)
    assert result.verdict == "stiction"
    assert result.seen.s == pytest.approx(scenario.valve.f_s + scenario.valve.f_d, rel=0.1)


@ALL
@pytest.mark.parametrize(
    ("kind", "verdict"), [("stiction", "stiction"), ("sinusoid", "no_stiction"), ("tuning", "no_stiction")]
)
@pytest.mark.parametrize("seed", [0, 4, 7])
def test_simulated_stems(detector, kind, verdict, seed):
    assert detector.detect(*simulated(kind, seed)[:2]).verdict == verdict


def test_kano_a_wants_a_measured_position():
    assert "no valve position" in detect(KanoA(), TRIANGLE, STUCK, PERIOD).reason


@pytest.mark.parametrize("detector", [KanoB(), Yamashita()], ids=lambda each: each.name)
def test_pv_stands_for_the_stem_only_where_it_jumps(detector):
    hints = LoopHints(acting="reverse")
    fast, slow = (signal.lfilter([1 / tau], [1, 1 / tau - 1], ONE_SLIP_STUCK) for tau in (3, 40))
    assert detect(detector, ONE_SLIP, fast, PERIOD, hints=hints).verdict == "stiction"
    assert "too slowly" in detect(detector, ONE_SLIP, slow, PERIOD, hints=hints).reason
    assert "too slowly" in detect(detector, ONE_SLIP, ONE_SLIP, PERIOD, hints=hints).reason


def test_a_direct_acting_loop_turns_pv_round():
    hints = LoopHints(acting="direct")
    assert detect(Yamashita(), ONE_SLIP, -ONE_SLIP_STUCK, PERIOD, hints=hints).verdict == "stiction"


@pytest.mark.parametrize(
    ("shape", "part"), [("sine", 1 / 3), ("triangle", 1 / 2), ("lag", np.log(2) * 5 / 50)]
)
def test_time_of_half_the_way(shape, part):
    angle = 2 * np.pi * np.arange(10_000) / PERIOD
    waves = {
        "sine": np.sin(angle),
        "triangle": signal.sawtooth(angle, 0.5),
        "lag": signal.lfilter([1 - np.exp(-1 / 5)], [1, -np.exp(-1 / 5)], np.sign(np.sin(angle + 0.01))),
    }
    assert time_of_half_the_way(waves[shape]) == pytest.approx(part, abs=0.02)
    assert time_of_half_the_way(np.zeros(9)) == 1.0


def test_stretches_within_a_band():
    cuts = standing(np.array([0.0, 0.5, 1.0, 1.5, 5.0, 5.2, 4.9]), 1.0)
    assert [(each.start, each.stop) for each in cuts] == [(0, 3), (3, 4), (4, 7)]


def test_symbols_by_hand():
    """OP up and down by one; the stem stands and then goes along, or goes where no sticking one goes."""
    op = np.array([0, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0.0])
    stem = np.array([0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1, 0.0])
    seen = qualitative_shape(Stem(op, stem, width=1, measured=True))
    assert "".join(each[0] for each in seen.symbols) == "ISSDSSSISSSDSSS"
    assert (seen.rho_1, seen.rho_3) == (
        0.5,
        0.5,
    )  # four of eight steps only OP moves, each time the stem follows
    turned = qualitative_shape(Stem(op, -stem, width=1, measured=True))
    assert turned.rho_1 == 0.5
    assert turned.rho_3 == 0.0  # the stem goes against OP
    assert qualitative_shape(Stem(np.zeros(9), np.zeros(9), width=1, measured=True)) is None


@ALL
@pytest.mark.parametrize(
    ("n", "period", "reason"), [(250, PERIOD, "fewer than 3 times"), (2000, 8.0, "samples a period")]
)
def test_their_limits(detector, n, period, reason):
    op = np.sin(2 * np.pi * np.arange(n) / period)
    assert reason in detect(detector, op, op, period, mv=op).reason


def test_noise_hides_a_stem():
    noise = 40 * np.random.default_rng(1).normal(size=2000)
    assert "noise" in detect(KanoA(), TRIANGLE, TRIANGLE, PERIOD, mv=STUCK + noise).reason


def test_they_need_no_steady_oscillation():
    window, _, _ = simulated("stiction", 13)
    unknown = Oscillation(detected=False, period=None, regularity=None)
    assert isinstance(stem_of(window, unknown), Stem)
    assert KanoA().detect(window, unknown).verdict == "stiction"
    assert "does not move" in KanoA().detect(replace(window, mv=np.zeros(len(window))), unknown).reason


def test_yamashita_is_at_a_loss_where_every_step_is_a_deviation_from_the_mean():
    """A limit (docs/methods/yamashita.md): the steps of a triangle are all as large as their deviation."""
    assert detect(Yamashita(), TRIANGLE, TRIANGLE, PERIOD, mv=TRIANGLE + 5 * NOISE).index > 0.1


def test_a_healthy_actuator_is_not_said_to_stick(recordings):
    """DAMADICS actuator 3, taken as healthy: its measured rod is used (never tuned on)."""
    table = np.genfromtxt(recordings / "damadics_actuator3.csv", delimiter=",", names=True)
    for detector in (KanoA(), KanoB(), Yamashita()):
        result = detect(detector, table["CV_pct"], table["F_tph"], None, mv=table["X_pct"])
        assert result.verdict in ("no_stiction", "not_applicable")
    assert result.verdict == "no_stiction"
