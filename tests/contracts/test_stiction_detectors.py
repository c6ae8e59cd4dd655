"""What every stiction detector promises: agent/checks/stiction_detectors.py, and an answer on any record."""

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.analysis.record.recording import LoopWindow
from agent.analysis.stiction import DETECTORS
from agent.checks import checks_of
from agent.checks.detector_records import detected, random_window, swinging

EACH = pytest.mark.parametrize("member", DETECTORS, ids=lambda member: member.name)


def test_their_names_differ():
    assert len({member.name for member in DETECTORS}) == len(DETECTORS)


@EACH
@pytest.mark.parametrize("check", checks_of("stiction_detectors"), ids=lambda check: check.name)
def test_contract(member, check):
    check(member)


@EACH
@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_it_answers_on_any_record(member, seed):
    _, window, oscillation = random_window(np.random.default_rng(seed))
    detected(member, window, oscillation)


SHORT, LONG = 5_000, 20_000
PER_SAMPLE = 3.0
"""By which a sample of the long record may take longer than one of the short: a detector that compares all
samples with each other takes four times as long."""
TRIES = 5
LEAST = 0.02
"""Seconds that count as the least: below, the clock and work that every record needs decide the ratio."""


@EACH
def test_its_time_grows_with_the_record_not_with_its_square(member):
    def seconds(samples):
        phase = 2 * np.pi * np.arange(samples) / 60
        op, pv = np.sin(phase) + 0.1 * np.random.default_rng(1).normal(size=(2, samples))
        window, oscillation = LoopWindow("long", 0.0, 1.0, op, pv), swinging(60.0)
        member.detect(window, oscillation)
        best = np.inf
        for _ in range(TRIES):
            began = time.process_time()
            member.detect(window, oscillation)
            best = min(best, time.process_time() - began)
        return best

    assert seconds(LONG) <= PER_SAMPLE * (LONG / SHORT) * max(seconds(SHORT), LEAST)
