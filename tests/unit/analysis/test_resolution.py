"""What a record cannot show: the least step, and noise of that size."""

import numpy as np

from agent.analysis.record.resolution import dithered, resolution


def test_the_least_change_is_found_across_gaps_and_repeated_values():
    assert resolution(np.array([1.0, 1.0, np.nan, 1.5, 1.5, 3.0, 2.75])) == 0.25
    assert resolution(np.full(9, 4.0)) == 0.0


def test_dither_stays_within_half_a_step_and_is_the_same_again():
    held = np.repeat([0.0, 1.0, 0.0], 20)
    assert np.max(np.abs(dithered(held) - held)) <= 0.5
    assert len(np.unique(dithered(held))) == held.size
    assert np.array_equal(dithered(held), dithered(held))
