"""Simulated recordings of one valve, and what is counted of them."""

from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.diagnosis import Diagnosis
from benchmarks.cases.random_group import GROUP_KINDS, random_group
from benchmarks.cases.random_loop import STICKING
from benchmarks.one_valve import DiagnosedGroup, by_kind, by_valve

SAID = Diagnosis("FIC101", "undecided", 0.0, "undecided", (), None, None, None)


def test_a_group_repeats_and_its_recordings_differ():
    one, again = (random_group("one_way", 1, 3) for _ in range(2))
    assert len(one.windows) == 3
    assert all(np.array_equal(a.op, b.op) for a, b in zip(one.windows, again.windows, strict=True))
    assert not any(np.array_equal(one.windows[0].op, each.op) for each in one.windows[1:])
    assert not one.sticks


def test_kinds_stick_or_not_as_their_names_say():
    assert {kind for kind in GROUP_KINDS if kind.endswith("stiction")} == STICKING & set(GROUP_KINDS)


def test_tables_count_verdicts_and_valves():
    windows = random_group("one_way", 1, 2).windows
    blamed = replace(SAID, verdict="stiction", confidence=0.9)
    groups = [
        DiagnosedGroup("flow", 1, windows, (SAID, blamed)),
        DiagnosedGroup("flow_stiction", 1, windows, (blamed, blamed)),
    ]
    kinds, valves = by_kind(groups), by_valve(groups)
    assert "| `flow` | 1 | 2 | 1 > 1 | 1 > 1 | 0 > 0 |" in kinds
    assert "| 4 recordings | sound | 1 | 1 | 0 | 0 | 0 |" in valves
    assert "| 4 recordings | sticks | 1 | 1 | 1 | 1 | 0 |" in valves
    assert groups[0].joined(groups[1]).probability == pytest.approx(0.0)
