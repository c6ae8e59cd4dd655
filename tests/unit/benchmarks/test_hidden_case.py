"""Loops of the benchmark of hidden effects: records of each kind in equal parts, each with its truth."""

from collections import Counter

import numpy as np
import pytest

from benchmarks.cases.hidden_case import RECORD_KINDS, drawn, parameters_of
from benchmarks.hidden_effects import jobs_of
from simulators.draws.hidden_effects import TRUTHS
from simulators.field import response


def test_each_truth_has_records_of_each_kind_in_equal_parts():
    counts = Counter((truth, record) for truth, _, record in jobs_of(len(RECORD_KINDS)))
    assert counts == {(truth, record): 1 for truth in TRUTHS for record in RECORD_KINDS}


@pytest.mark.parametrize("record", [each for each in RECORD_KINDS if each != "closed_loop"])
def test_the_instant_of_a_load_step_is_that_of_the_record_in_manual(record):
    plant, window = drawn("load_step", 60000, record)
    without = plant.scenario.model_copy(update={"load_steps": ()})
    moved = np.flatnonzero(np.abs(response(plant.scenario, window.op) - response(without, window.op)) > 0)
    known = parameters_of(plant, record)["load_step.time"]
    assert min(known) == pytest.approx(moved[0] * window.ts, abs=2 * window.ts)
    assert len(window.op) == len(plant.floor)
    assert window.sp is None
