"""Gauges of a loop's newest diagnosis: what is known, and nothing where it is not."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from agent.analysis.indices import INDICES
from agent.runtime.operate.metrics import LOOP_GAUGES
from tests.unit.analysis.diagnoses import CALM, HEALTHY, STICKING, WINDOW, judged

GAUGES = {name: value_of for name, _, value_of in LOOP_GAUGES}


def values(diagnosis):
    status = SimpleNamespace(diagnosis=diagnosis)
    names = ["s", "j", "period_seconds", "probability", *(f"index_{each.name}" for each in INDICES)]
    return {name: GAUGES[name](status) for name in names}


def test_a_sticking_valve_has_s_j_period_and_probability():
    found = judged(WINDOW, STICKING)
    shown = values(found)
    assert (shown["s"], shown["j"]) == (STICKING.stiction.s.value, STICKING.stiction.j.value)
    assert shown["period_seconds"] == pytest.approx(60.0, rel=0.02)
    assert shown["probability"] == found.probability
    assert shown["index_travel"] == found.indices["travel"] > 0


def test_what_is_not_known_is_absent():
    assert set(values(None).values()) == {None}
    shown = values(judged(CALM, replace(HEALTHY, stiction=None)))
    assert shown["s"] is shown["j"] is shown["period_seconds"] is None
    assert shown["index_service_factor"] is None  # no mode


def test_each_gauge_has_a_name_of_its_own_and_a_sentence():
    assert len(GAUGES) == len(LOOP_GAUGES)
    assert all(text[0].isupper() or text[0].isdigit() for _, text, _ in LOOP_GAUGES)
