"""Coarse samples allow no verdict; a probability is given also where the verdict is undecided."""

from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.indices.movement import Reversals
from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.reversals import significant_reversals
from agent.report.reasons import reasons
from tests.unit.analysis.diagnoses import CALM, HEALTHY, STICKING, WINDOW, N, T, judged


def sampled(samples_per_period):
    wave = 2 * np.pi * T / samples_per_period
    return LoopWindow("x", 0.0, 10.0, op=50 + np.sin(wave), pv=np.sin(wave + 1))


def test_coarse_samples_are_reported_and_too_coarse_ones_allow_no_verdict():
    assert any("14 samples a period" in reason for reason in reasons(judged(sampled(14), HEALTHY)))
    for samples in (8, 10, 11):
        for answer in (HEALTHY, STICKING):
            found = judged(sampled(samples), answer)
            assert found.verdict == "not_testable"
            assert found.samples_per_period == pytest.approx(samples, rel=0.02)
            assert any("at least 12 are needed" in reason for reason in reasons(found))


def test_a_coarse_op_is_not_said_to_stand():
    """Four samples a period: from scan to scan OP moves as far as in all, which looks like noise."""
    saw = 50 + np.abs((T / 2.15) % 2 - 1)
    window = LoopWindow("x", 0.0, 10.0, op=saw, pv=np.sin(np.pi * T / 2.15))
    assert significant_reversals(saw) < 2
    assert Reversals().of(window, None) is None
    found = reasons(judged(window, STICKING))
    assert any("at least 12 are needed" in each for each in found)
    assert not any("revers" in each for each in found)


def test_the_probability_is_given_also_where_the_verdict_is_undecided():
    assert judged(WINDOW, STICKING).probability > 0.5
    torn = replace(STICKING, decision="undecided", evidence=1.6, quick_evidence=1.0, log_likelihood_ratio=0.0)
    undecided = judged(CALM, torn)
    assert undecided.verdict == "undecided"
    assert 0 < undecided.probability < 1
    assert judged(replace(WINDOW, op=np.full(N, 1.0)), STICKING).probability is None
    assert judged(WINDOW, STICKING).samples_per_period == pytest.approx(60, rel=0.05)
