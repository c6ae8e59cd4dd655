"""What ``free_run`` fits: gaps bridged, nuisance removed, the first periods, a start at rest."""

from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import LoopWindow
from agent.identify.problem import (
    LEAST_SAMPLES,
    SHORT_GAP,
    after_gaps,
    bridge,
    first_periods,
    high_pass,
    quiet_start,
)
from agent.physics.processes.decimation import block_means
from agent.physics.valves.damped_stem import damped_stem
from tests.reference.free_run_twins import first_order
from tests.unit.quantify.shipped_plants import SAMPLES, plant


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


def test_the_first_part_of_a_record_that_begins_with_a_gap_goes_on_to_where_enough_counts():
    _, window = plant("tic302_second_order")
    pv = window.pv.copy()
    pv[:400] = np.nan
    whole = pose(replace(window, pv=pv))
    part = first_periods(whole, 1.0)
    assert part.weight.sum() == LEAST_SAMPLES
