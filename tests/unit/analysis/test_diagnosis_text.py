"""The words of a diagnosis: numbers with intervals where there are any, and plain words where not."""

import math
from dataclasses import replace

import pytest

from agent.analysis.diagnosis import Diagnosis, RecordSummary
from agent.analysis.evidence.weighing import Weighed, Witness
from agent.analysis.results import (
    CauseShare,
    IntervalEstimate,
    Oscillation,
    ProcessEstimate,
    ProcessIntervals,
    Quantification,
    StictionEstimate,
)
from agent.report.diagnosis_json import diagnosis_json
from agent.report.diagnosis_text import diagnosis_lines
from agent.report.reasons import reasons
from agent.units import FrictionBands

SURE = StictionEstimate(
    f_s=IntervalEstimate(6.0, 5.5, 6.5),
    f_d=IntervalEstimate(0.6, 0.1, 1.1),
    s=IntervalEstimate(6.6, 6.5, 6.7),
    j=IntervalEstimate(5.4, 1.25, 6.6),
    identifiable_s=True,
    identifiable_j=False,
)
PROCESS = ProcessEstimate(
    "fopdt", 1.5, 12.0, 4.0, intervals=ProcessIntervals(gain=(1.4, 1.6), tau=(11.0, 13.0), delay=(3.5, 4.5))
)
FOUND = Quantification("free_run", SURE, PROCESS, 91.0, 60.0, 16.0, "stiction")
DIAGNOSIS = Diagnosis(
    loop="FIC101",
    verdict="stiction",
    confidence=0.97,
    cause="stiction",
    causes=(CauseShare("stiction", 0.9),),
    stiction_class="stick_slip",
    oscillation=Oscillation(detected=True, period=60.0, regularity=9.0),
    quantification=FOUND,
    record=RecordSummary(samples=600, gaps=0, duplicates=0, ts=1.0, op_span=20.0),
)


def lines(**changes):
    return list(diagnosis_lines(replace(DIAGNOSIS, quantification=replace(FOUND, **changes))))


def numbers(written):
    """Return the lines but for reasons and advice."""
    return [line for line in written if not line.startswith(("  - ", "  > "))]


def test_a_search_that_spent_its_budget_says_so_beside_its_numbers():
    spent = replace(DIAGNOSIS, quantification=replace(FOUND, search_spent=True))
    assert not [each for each in reasons(DIAGNOSIS) if "may be wrong" in each]
    assert [each for each in reasons(spent) if "S and J may be wrong" in each]
    assert diagnosis_json(spent, "fic101")["fit"]["search_spent"] is True
    assert not [each for each in reasons(replace(spent, verdict="no_stiction")) if "may be wrong" in each]


def test_numbers_with_their_intervals():
    assert numbers(lines()) == [
        "FIC101: stiction (confidence 0.97)",
        "  S = 6.6 OP units, 90 % interval 6.5 to 6.7",
        "  J = 5.4 OP units, but not identifiable: the record allows 1.25 to 6.6",
        "  f_S = 6 OP units, 90 % interval 5.5 to 6.5",
        "  f_D = 0.6 OP units, 90 % interval 0.1 to 1.1",
        "  gain = 1.5 PV units per OP unit, 90 % interval 1.4 to 1.6",
        "  time constant = 12 s, 90 % interval 11 to 13",
        "  delay = 4 s, 90 % interval 3.5 to 4.5",
    ]


def test_without_intervals_the_reasons_say_the_numbers():
    bare = StictionEstimate.of(FrictionBands(6.0, 0.6))
    written = lines(stiction=bare, process=replace(PROCESS, intervals=None))
    assert numbers(written) == ["FIC101: stiction (confidence 0.97)"]
    assert "  - the valve shows stick and slip" in written
    assert any("S = 6.6 (33 % of the span of OP) and J = 5.4 to 91 %" in line for line in written)


def test_what_the_record_does_not_report_at_all():
    unknown = replace(StictionEstimate.of(FrictionBands(6.0, 0.6)), identifiable_j=False)
    assert "  J = 5.4 OP units, but not identifiable: the record does not determine it" in lines(
        stiction=unknown
    )


@pytest.mark.parametrize("verdict", ["no_stiction", "not_testable"])
def test_no_amount_of_stiction_is_reported_of_a_valve_that_is_not_blamed(verdict):
    told = list(diagnosis_lines(replace(DIAGNOSIS, verdict=verdict, cause="no_oscillation")))
    assert len(numbers(told)) == 1
    assert told[0].endswith(", no oscillation")


def test_what_to_do_comes_before_why_and_why_before_the_numbers():
    signs = [line[2] for line in lines()[1:]]
    kinds = [">-".find(sign) if sign in ">-" else 2 for sign in signs]
    assert kinds == sorted(kinds)
    assert set(kinds) == {0, 1, 2}


def test_an_integrator_has_no_time_constant():
    level = ProcessEstimate(
        "integrator", 0.01, None, 4.0, intervals=ProcessIntervals((0.009, 0.011), None, (3, 5))
    )
    told = lines(process=level)
    assert "  gain = 0.01 PV units per OP unit and s, 90 % interval 0.009 to 0.011" in told
    assert not [line for line in told if "time constant" in line]
    assert diagnosis_json(replace(DIAGNOSIS, quantification=replace(FOUND, process=level)), "x.csv")[
        "process"
    ] == {
        "kind": "integrator",
        "gain": 0.01,
        "tau_s": None,
        "delay_s": 4.0,
        "intervals": {"gain": [0.009, 0.011], "tau_s": None, "delay_s": [3.0, 5.0]},
    }


def test_json_has_intervals_and_what_is_identifiable():
    told = diagnosis_json(DIAGNOSIS, "x.csv")
    assert told["stiction"]["j"] == {"value": 5.4, "low": 1.25, "high": 6.6}
    assert told["stiction"]["identifiable"] == {"s": True, "j": False}
    assert told["process"]["intervals"] == {"gain": [1.4, 1.6], "tau_s": [11.0, 13.0], "delay_s": [3.5, 4.5]}


@pytest.mark.parametrize(
    "found", [None, replace(FOUND, process=None), replace(FOUND, process=replace(PROCESS, intervals=None))]
)
def test_json_keeps_its_keys_where_nothing_is_known(found):
    process = diagnosis_json(replace(DIAGNOSIS, quantification=found), "x.csv")["process"]
    assert list(process) == ["kind", "gain", "tau_s", "delay_s", "intervals"]
    assert process["intervals"] is None


def test_evidence_is_named_by_its_strength_the_strongest_first():
    odds = {"kano_a": 2.0, "innovations": 973.0, "free_run": 7.2, "damarla": 26.0, "horch_ccf": 1 / 5}
    witnesses = tuple(Witness(name, math.log(each)) for name, each in odds.items())
    found = replace(
        DIAGNOSIS, weighed=Weighed(0.8, witnesses), quantification=replace(FOUND, quick_evidence=1.0)
    )
    said = "very strong by innovations; strong by damarla; clear by free_run; weak by kano_a"
    assert f"evidence for stiction: {said}" in reasons(found)
    assert "evidence against stiction: clear by horch_ccf" in reasons(found)


def test_what_changes_no_odds_is_no_evidence():
    witnesses = (Witness("horch_ccf", 1.2), Witness("free_run", 0.01), Witness("rossi_scali", -0.02))
    found = replace(
        DIAGNOSIS, weighed=Weighed(0.8, witnesses), quantification=replace(FOUND, quick_evidence=1.0)
    )
    assert "evidence for stiction: clear by horch_ccf" in reasons(found)
    assert not any("evidence against" in each for each in reasons(found))


def test_a_record_that_would_hide_stiction_says_so_where_none_is_found():
    hides = replace(FOUND, would_show=0.12, decision="undecided")
    words = [
        each
        for each in reasons(replace(DIAGNOSIS, verdict="undecided", quantification=hides))
        if "100" in each
    ]
    (said,) = words
    assert said.startswith("this record would show a sticking valve in 12 of 100 cases: OP moves too little")
    shows = replace(hides, would_show=0.9)
    for verdict, found in (("undecided", shows), ("stiction", hides)):
        others = reasons(replace(DIAGNOSIS, verdict=verdict, quantification=found))
        assert not [each for each in others if "of 100 cases" in each]
