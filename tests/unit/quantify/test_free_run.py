"""``free_run`` on the shipped simulated plants, whose valves obey laws that it does not fit."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from agent.analysis.quantify.free_run import FreeRun
from agent.analysis.quantify.free_run.problem import (
    SHORT_GAP,
    after_gaps,
    bridge,
    first_periods,
    high_pass,
    pose,
    quiet_start,
)
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.physics.processes.decimation import block_means
from agent.physics.valves.damped_stem import damped_stem
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate
from simulators.scenario import load_scenario
from tests.conftest import ROOT
from tests.reference.free_run_twins import first_order

SCENARIOS = sorted((ROOT / "config" / "scenarios").glob("*.yaml"))
STICKING = (
    "fic101_stick_slip",
    "fic102_moderate_stiction",
    "lic201_dead_band",
    "pic401_direct_stick_slip",
    "tic301_weak_stiction",
    "tic302_second_order",
)
SAMPLES = 1200
FREE_RUN = FreeRun()


@cache
def plant(name):
    """A scenario and the window that the demo would see of it first."""
    scenario = load_scenario(ROOT / "config" / "scenarios" / f"{name}.yaml")
    record = simulate(scenario)
    return scenario, LoopWindow(scenario.loop, 0.0, scenario.ts, record.op[:SAMPLES], record.pv[:SAMPLES])


@cache
def measured(name):
    return FREE_RUN.quantify(plant(name)[1])


def true_s(name):
    truth = plant(name)[0].truth
    return truth.f_s + truth.f_d


def op_span(name):
    return plant(name)[1].op_span


def with_gaps(window, length, which="both"):
    """A tenth is missing, in blocks."""
    op, pv = window.op.copy(), window.pv.copy()
    for start in range(2 * length, SAMPLES, 10 * length):
        if which in ("op", "both"):
            op[start : start + length] = np.nan
        if which in ("pv", "both"):
            pv[start : start + length] = np.nan
    return replace(window, op=op, pv=pv)


@pytest.mark.parametrize("name", [path.stem for path in SCENARIOS])
def test_the_verdict_is_the_truth(name):
    scenario, _ = plant(name)
    found = measured(name)
    if name == "tic303_drift":  # a load that wanders slower than any wave leaves it open
        assert found.decision in {"no_stiction", "undecided"}
    else:
        assert found.decision == scenario.truth.verdict
    assert found.failure is None
    assert found.free_run_percent >= found.linear_percent - 1e-9
    if scenario.truth.verdict == "stiction":
        assert found.evidence > 2
        assert found.free_run_percent > found.linear_percent
    else:
        assert found.evidence < 1.5


def test_s_is_right_where_the_record_determines_it():
    known = [name for name in STICKING if measured(name).stiction.identifiable_s]
    assert known
    for name in known:
        assert measured(name).stiction.s.value == pytest.approx(true_s(name), abs=0.02 * op_span(name))


def test_intervals_hold_the_true_s_nine_times_in_ten():
    missed = [
        name
        for name in STICKING
        if not measured(name).stiction.s.low <= true_s(name) <= measured(name).stiction.s.high
    ]
    assert len(missed) <= 1  # of six
    for name in missed:
        assert not measured(name).stiction.identifiable_s


@pytest.mark.parametrize("name", STICKING)
def test_bands_add_up(name):
    bands = measured(name).stiction
    assert bands.s.value == pytest.approx(bands.f_s.value + bands.f_d.value)
    assert bands.j.value == pytest.approx(bands.f_s.value - bands.f_d.value)


def test_the_process_comes_in_the_units_of_the_plant():
    process = measured("pic401_direct_stick_slip").process
    assert process.kind == "fopdt"
    assert process.gain == pytest.approx(-0.4, rel=0.15)
    # PV first moves one sample after OP has been set, and the load's dead time later
    assert process.delay == pytest.approx(1.5 + 1.0, abs=1.0)


def test_an_integrating_loop_has_no_time_constant():
    scenario, window = plant("lic201_dead_band")
    found = FREE_RUN.quantify(window.with_hints(LoopHints(integrating=True)))
    assert (found.process.kind, found.process.tau) == ("integrator", None)
    low, high = found.process.intervals.gain
    assert low <= scenario.process.gain <= high
    assert found.decision == "stiction"


@pytest.mark.parametrize(("order", "kind"), [(1, "fopdt"), (2, "sopdt")])
def test_a_given_delay_and_order_are_kept(order, kind):
    _, window = plant("tic302_second_order")
    process = FREE_RUN.quantify(window.with_hints(LoopHints(delay=5, order=order, integrating=False))).process
    assert process.delay == pytest.approx(5 * window.ts)
    # where the second pole buys nothing the simpler process is told, but never the other way round
    assert process.kind == kind


def test_a_gain_of_the_wrong_sign_is_refused():
    _, window = plant("pic401_direct_stick_slip")
    right, wrong = (FREE_RUN.quantify(window.with_hints(LoopHints(acting=a))) for a in ("direct", "reverse"))
    assert right.process.gain < 0 < wrong.process.gain
    assert wrong.free_run_percent < right.free_run_percent - 5


@pytest.mark.parametrize(
    "name", ["fic101_stick_slip", "tic302_second_order", "pic402_sinusoid", "fic103_healthy"]
)
def test_short_gaps_do_not_change_the_verdict(name):
    scenario, window = plant(name)
    assert FREE_RUN.quantify(with_gaps(window, 5)).decision == scenario.truth.verdict


@pytest.mark.parametrize(
    "name", ["fic101_stick_slip", "tic302_second_order", "pic402_sinusoid", "fic103_healthy"]
)
def test_long_gaps_may_leave_it_open_but_never_turn_it(name):
    scenario, window = plant(name)
    assert FREE_RUN.quantify(with_gaps(window, 20)).decision in {scenario.truth.verdict, "undecided"}


@pytest.mark.parametrize("name", ["pic401_direct_stick_slip", "fic104_tight_tuning"])
@pytest.mark.parametrize("which", ["op", "pv"])
def test_nor_do_long_gaps_in_one_of_the_two(name, which):
    scenario, window = plant(name)
    assert FREE_RUN.quantify(with_gaps(window, 20, which)).decision in {
        scenario.truth.verdict,
        "undecided",
    }


@pytest.mark.parametrize(
    ("start", "which"),
    [
        (300, "both"),
        (900, "pv"),
        pytest.param(300, "pv", marks=pytest.mark.bench),
        pytest.param(900, "both", marks=pytest.mark.bench),
    ],
)
def test_one_gap_leaves_s_as_it_is(start, which):
    _, window = plant("fic101_stick_slip")
    op, pv = window.op.copy(), window.pv.copy()
    pv[start : start + 20] = np.nan
    if which == "both":
        op[start : start + 20] = np.nan
    found = FREE_RUN.quantify(replace(window, op=op, pv=pv))
    assert found.decision == "stiction"
    assert found.stiction.s.value == pytest.approx(true_s("fic101_stick_slip"), abs=0.02 * window.op_span)


def test_the_model_is_given_in_the_units_of_the_record():
    _, window = plant("fic101_stick_slip")
    found = measured("fic101_stick_slip")
    assert found.model_pv.shape == found.model_mv.shape == (SAMPLES,)
    # air that comes late lets OP run a little ahead of the break-away
    assert np.abs(window.op - found.model_mv).max() <= 1.01 * found.stiction.f_s.value
    rest = np.sqrt(np.mean((found.model_pv - window.pv) ** 2)) / np.std(window.pv)
    # the fit counts high-passed blocks after the start, this every sample
    assert found.free_run_percent == pytest.approx(100 * (1 - rest), abs=1)


def test_a_record_that_is_the_model_gives_its_parameters_back():
    n = 800
    op = 50 + 6 * np.sin(np.arange(n) / 9) + 0.1 * np.cumsum(np.random.default_rng(0).standard_normal(n))
    position = damped_stem(op, 3.0, 1.0, op[0] - 1.0, 0.01, 0.01, 1e-8)
    pv = 20 - 0.5 * np.roll(first_order(position - position[0], 6.0), 4)
    noise = 0.005 * np.random.default_rng(1).standard_normal(n)
    found = FREE_RUN.quantify(LoopWindow("x", 0.0, 2.0, op, pv + noise, hints=LoopHints(acting="direct")))
    assert found.decision == "stiction"
    assert found.stiction.f_s.value == pytest.approx(3.0, abs=0.1)
    assert found.stiction.f_d.value == pytest.approx(1.0, abs=0.1)
    assert found.process.gain == pytest.approx(-0.5, rel=0.05)
    assert found.process.tau == pytest.approx(12.0, rel=0.1)
    assert found.process.delay == pytest.approx(8.0, abs=0.5)
    assert found.free_run_percent > 97


def test_a_line_goes_through_each_gap():
    nan = np.nan
    op = np.array([nan, 1.0, nan, nan, 4.0, nan])
    assert bridge(op).tolist() == [1, 1, 2, 3, 4, 4]


def test_what_follows_a_long_gap_does_not_count():
    op = np.arange(60.0)
    op[10:12] = np.nan  # short against a period of 24
    op[20:24] = np.nan
    op[50:] = np.nan
    assert np.flatnonzero(after_gaps(op, 24.0)).tolist() == list(range(24, 32))
    assert np.flatnonzero(after_gaps(op, 10.0)).tolist() == [*range(12, 16), *range(24, 29)]
    assert not after_gaps(np.arange(60.0), 24.0).any()
    assert SHORT_GAP * 24.0 >= 2


@pytest.mark.parametrize(
    ("op", "pv", "why"),
    [
        (np.full(600, 50.0), np.arange(600.0), "OP does not move"),
        (np.arange(600.0), np.full(600, 3.0), "PV does not move"),
        (np.arange(49.0), np.arange(49.0), "49 samples"),
        (np.full(600, np.nan), np.arange(600.0), "0 samples"),
        (
            np.where(np.arange(600) % 60 < 10, np.arange(600.0) % 7, np.nan),
            np.arange(600.0),
            "OP has so many",
        ),
    ],
)
def test_what_cannot_be_measured_is_told_not_raised(op, pv, why):
    found = FREE_RUN.quantify(LoopWindow("x", 0.0, 1.0, op, pv))
    assert found.failure.startswith(why)
    assert (found.decision, found.stiction, found.evidence) == ("not_applicable", None, None)


def test_the_nuisance_is_gone_from_what_is_fitted():
    _, window = plant("fic103_healthy")
    tilted = replace(window, pv=window.pv + 300 + 0.02 * np.arange(SAMPLES))
    plain, other = pose(window), pose(tilted)
    np.testing.assert_allclose(plain.pv, other.pv, atol=1e-8)
    np.testing.assert_allclose(plain.basis.T @ plain.basis, np.eye(plain.basis.shape[1]), atol=1e-12)


@pytest.mark.parametrize("periods", [3.0, 4.0])
@pytest.mark.parametrize("gap", [0, 90])
def test_the_first_periods_are_the_problem_of_a_shorter_record(periods, gap):
    _, window = plant("tic302_second_order")
    pv = window.pv + 0.01 * np.arange(SAMPLES)
    pv[160 : 160 + gap] = np.nan
    window = replace(window, pv=pv)
    whole = pose(window)
    part = first_periods(whole, periods)
    blocks = len(part.pv)
    assert whole.block == 2  # else blocks would be samples
    assert (blocks - 1) * whole.block < periods * whole.period <= blocks * whole.block
    assert len(part.op) == blocks * whole.block
    np.testing.assert_array_equal(part.weight, whole.weight[:blocks])
    np.testing.assert_allclose(part.basis.T @ part.basis, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(part.basis.T @ part.pv, 0.0, atol=1e-9)
    np.testing.assert_allclose(part.basis[part.weight == 0], 0.0, atol=1e-12)

    # level, slope and memory fitted to what the filter passes of the shorter record alone
    passed = high_pass(block_means(bridge(window.pv[: len(part.op)]), part.block), part.keep)
    counts = part.weight > 0
    at = np.flatnonzero(counts)
    columns = np.column_stack([np.ones(len(at)), at, part.keep**at])
    coefficients, *_ = np.linalg.lstsq(columns, passed[counts])
    np.testing.assert_allclose(part.pv[counts], passed[counts] - columns @ coefficients, atol=1e-8)


def test_short_horizons_keep_eighty_blocks_and_long_ones_the_record():
    problem = pose(plant("fic101_stick_slip")[1])
    assert len(first_periods(problem, 1.0).pv) == 80
    assert len(first_periods(problem, 1e6).pv) == len(problem.pv)
    assert first_periods(problem, np.inf) is problem


def swinging(quiet, seed=1):
    """A loop at rest for ``quiet`` samples, then swinging with a period of 40: OP and PV."""
    random = np.random.default_rng(seed)
    t = np.arange(800)
    op = 50 + 4 * np.sin(2 * np.pi * t / 40) * (t >= quiet) + 0.05 * random.standard_normal(t.size)
    position = damped_stem(op, 2.0, 1.0, op[0], 0.3, 0.1, 0.01)
    pv = 80 + first_order(position - position[0], 8.0) + 0.02 * random.standard_normal(t.size)
    return op, pv


@pytest.mark.parametrize("quiet", [0, 90, 300])
def test_a_loop_begins_to_swing_where_its_op_does(quiet):
    begins = quiet_start(swinging(quiet)[0], 40.0)
    assert quiet - 60 <= begins <= quiet  # a window of one and a half periods that sees it


def test_neither_one_large_move_nor_a_loop_that_comes_to_rest_is_a_quiet_start():
    op = swinging(0)[0]
    op[300:340] += 60.0
    assert quiet_start(op, 40.0) == 0
    op[300:] = op[0]
    assert quiet_start(op, 40.0) == 0


def test_the_first_periods_of_a_record_that_begins_at_rest_hold_as_many_swings():
    op, pv = swinging(300)
    problem = pose(LoopWindow("FIC1", 0.0, 1.0, op, pv))
    part = first_periods(problem, 4.0)
    assert problem.block == 1
    assert len(part.op) == problem.quiet + np.ceil(4 * problem.period)


def test_a_loop_that_rests_for_six_periods_before_it_swings_is_fitted():
    scenario = random_plant(2073, "stiction")
    record = simulate(scenario)
    window = LoopWindow(scenario.loop, 0.0, scenario.ts, record.op, record.pv)
    assert pose(window).quiet > 5 * pose(window).period
    found = FREE_RUN.quantify(window)
    assert found.free_run_percent > 90  # 73 where the search looks at periods in which nothing moves
    assert abs(found.stiction.j.value - record.truth.f_s + record.truth.f_d) < 0.05 * window.op_span
