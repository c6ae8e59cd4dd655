"""Records of one run at many rates, and the tables of their diagnoses."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.cases.rated_loop import RATES, SCANS, RatedLoop, recordings
from benchmarks.sampling_rate import SOUND, intervals, jobs, verdicts


def rated(kind="stiction", verdict="stiction", s=(2.0, 3.0, 4.0), probability=0.9):
    low, value, high = s
    return RatedLoop(
        kind=kind,
        seed=1,
        how="samples",
        rate=12,
        verdict=verdict,
        confidence=0.9,
        probability=probability,
        period=1.0,
        gates="",
        op_span=10.0,
        op_step=0.1,
        true_s=3.5,
        true_j=1.0,
        s=value,
        s_low=low,
        s_high=high,
        j=None,
        j_low=None,
        j_high=None,
        evidence=None,
        quick=None,
        likelihood=None,
        fit=None,
    )


def test_samples_are_single_scans_and_means_are_of_all_between():
    scans = np.arange(30.0 * SCANS)
    found = {
        (rate, how): (op, pv)
        for rate, how, op, pv in recordings(SimpleNamespace(op=scans, pv=2 * scans), (4, 48, 120))
    }
    assert len(found) == 6
    op, pv = found[4, "samples"]
    np.testing.assert_array_equal(op, 60.0 * np.arange(120))
    op, pv = found[4, "means"]
    np.testing.assert_allclose(op, 60.0 * np.arange(120) + 29.5)
    np.testing.assert_allclose(pv, 2 * op)
    assert len(found[120, "means"][0]) == 3000


def test_the_tables_count_what_is_firm_and_wrong_and_what_intervals_hold():
    loops = [
        rated(),
        rated(verdict="no_stiction", s=(2.0, 2.5, 3.0), probability=0.1),
        rated(verdict="not_testable", s=(None, None, None), probability=None),
        rated(kind="tuning", verdict="stiction"),
        rated(kind="tuning", verdict="undecided"),
    ]
    assert "| 12 | samples | 5 | 2 of 5 | 1 of 3 | 0 of 2 | 1 of 5 | 1 of 5 | 0.10 to 0.90 |" in verdicts(
        loops
    )
    assert "| 12 | samples | 2 | 50 | 20 |" in intervals(loops)


@pytest.mark.parametrize("sticking", [1, 6])
def test_every_loop_is_recorded_at_every_rate(sticking):
    wanted = jobs(sticking)
    assert len(wanted) == len(RATES) * (sticking + len(SOUND) * -(-sticking // 3)) == len(set(wanted))
