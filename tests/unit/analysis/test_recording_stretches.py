"""Which stretches of a long recording are judged."""

import numpy as np

from agent.analysis.record.recording import LoopWindow
from agent.analysis.recording_stretches import LONGEST, MOST, PERIODS, newest_stretch, part_of, stretches_of


def swinging(samples, period=100.0, quiet=()):
    """OP and PV swing; within the slices of ``quiet`` by a tenth."""
    amplitude = np.full(samples, 5.0)
    for each in quiet:
        amplitude[each] = 0.5
    op = 50 + amplitude * np.sin(2 * np.pi * np.arange(samples) / period)
    return LoopWindow("loop", 1000.0, 2.0, op, op + 1, sp=np.full(samples, 51.0))


def test_a_recording_as_long_as_a_window_stays_whole():
    assert stretches_of(swinging(LONGEST)) == [slice(0, LONGEST)]


def test_a_longer_one_is_cut_into_equal_parts_without_a_rest():
    cut = stretches_of(swinging(3 * LONGEST))
    assert cut == [slice(0, LONGEST), slice(LONGEST, 2 * LONGEST), slice(2 * LONGEST, 3 * LONGEST)]
    lengths = {each.stop - each.start for each in stretches_of(swinging(LONGEST + 1))}
    assert lengths <= {LONGEST // 2, LONGEST // 2 + 1}


def test_a_slow_loop_keeps_its_periods():
    period = 2000.0
    cut = stretches_of(swinging(40_000, period))
    assert 1 < len(cut) < 40_000 / LONGEST
    assert min(each.stop - each.start for each in cut) > 0.5 * PERIODS * period
    assert len(stretches_of(swinging(10_000, period))) == 1


def test_of_a_week_a_dozen_are_judged_each_where_op_moves_most():
    samples = 4 * MOST * LONGEST
    lively = [range(0, samples, LONGEST)[k] for k in range(1, 4 * MOST, 4)]
    still = [slice(k, k + LONGEST) for k in range(0, samples, LONGEST) if k not in lively]
    cut = stretches_of(swinging(samples, quiet=still))
    assert [each.start for each in cut] == lively


def test_where_samples_are_missing_little_is_seen():
    window = swinging(2 * MOST * LONGEST)
    pv = window.pv.copy()
    pv[: LONGEST - 100] = np.nan
    gone = LoopWindow("loop", 0.0, 1.0, window.op, pv)
    assert stretches_of(gone)[0] == slice(LONGEST, 2 * LONGEST)


def test_a_recording_that_stands_still_stays_whole():
    op = np.full(3 * LONGEST, 50.0)
    assert stretches_of(LoopWindow("loop", 0.0, 1.0, op, op)) == [slice(0, 3 * LONGEST)]


def test_a_part_has_its_time_and_all_columns():
    part = part_of(swinging(1000), slice(200, 300))
    assert (part.start, len(part), part.ts) == (1400.0, 100, 2.0)
    assert part.sp is not None
    assert len(part.sp) == 100
    assert part.mv is None


def test_the_newest_stretch_ends_with_the_window():
    window = swinging(3 * LONGEST)
    newest = newest_stretch(window)
    assert len(newest) == LONGEST
    assert newest.time[-1] == window.time[-1]
    assert newest_stretch(newest) is newest
