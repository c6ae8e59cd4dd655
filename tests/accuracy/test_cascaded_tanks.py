"""The cascaded-tanks laboratory data: overflow is the effect that a model of two tanks lacks.

The numbers asked for are those of issue 5; docs/workbench/cascaded_tanks.md tells what was measured.
"""

import csv

import numpy as np
import pytest

from agent.analysis.recording import LoopWindow
from agent.workbench.session import Workbench

TS = 4.0


@pytest.fixture(scope="module")
def tanks(recordings):
    with (recordings / "cascaded_tanks.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    half = {
        name: LoopWindow(
            name, 0.0, TS, *(np.array([float(row[f"{c}{name}"]) for row in rows]) for c in ("u", "y"))
        )
        for name in ("Est", "Val")
    }
    return Workbench(half["Est"], base="two_tanks", validate=half["Val"])


def test_two_tanks_without_overflow_are_half_a_volt_off_where_nothing_was_fitted(tanks):
    assert 0.5 < tanks.staircase()[0].rmse_validation < 0.7


@pytest.mark.bench
@pytest.mark.timeout(600)
def test_overflow_is_named_and_the_error_falls(tanks):
    decision = tanks.candidates()
    assert (decision.kind, decision.effect) == ("confirmed", "overflow")
    assert tanks.add("overflow").rmse_validation < 0.3
