"""Which recordings of a command are of one valve, and when their answers come."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from agent.analysis.data_quality import data_quality
from agent.analysis.diagnose import diagnose
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import Quantification, StictionEstimate
from agent.cli.diagnosing.answer import Answer, Task, printed_of
from agent.cli.diagnosing.one_valve import together, valve_of, valves
from agent.report.reasons import reasons
from agent.units import FrictionBands
from connectors.recording import Columns

LITTLE = Quantification(
    quantifier="free_run",
    stiction=StictionEstimate.of(FrictionBands(2.0, 1.0)),
    process=None,
    free_run_percent=70.0,
    linear_percent=60.0,
    evidence=1.5,
    decision="undecided",
    quick_evidence=1.2,
    turns=1,
    log_likelihood_ratio=15.0,
)


class Told:
    name = "free_run"

    def quantify(self, _window):
        return LITTLE


def answer(name, seed, **other):
    op, pv = np.random.default_rng(seed).normal(size=(2, 300)).cumsum(axis=1)
    window = LoopWindow(name, 0.0, 1.0, op=op, pv=pv)
    task = Task(Path(f"{name}.csv"), Columns(), LoopHints(), None, None, shared=True)
    alone = diagnose(window, quantifier=Told())
    found = printed_of(task, alone, data_quality(window, alone), None)
    return replace(Answer(task, found, diagnosis=alone, window=window, shown=window), **other)


@pytest.mark.parametrize(
    ("name", "valve"),
    [
        ("2411_FIC20102_40.csv", "2411_FIC20102"),
        ("2411_FIC20102_53.parquet", "2411_FIC20102"),
        ("FIC101-3.csv", "FIC101"),
        ("2111_FIC40102B_5.csv", "2111_FIC40102B"),
        ("CDU_LIC63001_1.csv", "CDU_LIC63001"),
        ("PIC101_2026-03-01.csv", "PIC101"),
        ("TIC101-2026-03-01T0800Z.csv", "TIC101"),
    ],
)
def test_a_tag_with_a_number_or_a_date_names_the_valve(name, valve):
    assert valve_of(Path(name)) == (Path(), valve)


@pytest.mark.parametrize(
    "name",
    [
        "case_001.csv",
        "sim_12.csv",
        "CHEM1.csv",
        "CHEM10.csv",
        "loop-3.csv",
        "FIC101.csv",
        "FIC101_north.csv",
        "FIC101_1_north.csv",
        "SUPERLOOP101_2.csv",
        "FIC12_3.csv",
        "fic101_3.csv",
        "_40.csv",
    ],
)
def test_other_names_say_nothing(name):
    assert valve_of(Path(name)) is None


def test_valves_of_a_command():
    names = ["FIC101_1.csv", "case_001.csv", "FIC102_1.csv", "FIC101_2.csv", "case_001.csv", "b/FIC101_3.csv"]
    paths = [Path(name) for name in names]
    assert valves(paths, each=False, one_valve=False) == [0, 1, 2, 0, 4, 5]
    assert valves(paths, each=True, one_valve=False) == [0, 1, 2, 3, 4, 5]
    assert valves(paths, each=False, one_valve=True) == [0] * 6


def test_answers_keep_their_order_and_wait_no_longer_than_they_must():
    names, valve = ("a", "b", "c", "d", "e"), [0, 1, 2, 1, 4]
    come = []

    def answers():
        for k, name in enumerate(names):
            come.append(name)
            yield answer(name, k)

    said = [(each.task.path.stem, len(come)) for each in together(answers(), valve)]
    assert said == [("a", 1), ("b", 4), ("c", 4), ("d", 4), ("e", 5)]


def test_only_those_of_the_valve_are_moved():
    given = [answer(f"FIC101_{k}", k) for k in range(5)]
    found = list(together(iter(given), [0, 0, 2, 0, 0]))
    assert [each.diagnosis.verdict for each in found] == [
        "stiction",
        "stiction",
        "undecided",
        "stiction",
        "stiction",
    ]
    assert found[2] == given[2]
    assert all("other recording" in each.found.text for k, each in enumerate(found) if k != 2)
    assert [each.found.finding.verdict for each in found] == [each.diagnosis.verdict for each in found]


def test_a_file_that_could_not_be_read_is_left_out():
    bad = answer(
        "FIC101_9", 9, found=None, diagnosis=None, window=None, shown=None, faults=("cannot be read",)
    )
    found = list(together(iter([answer("FIC101_0", 0), bad]), [0, 0]))
    assert found[1] == bad
    assert found[0].diagnosis.verdict == "undecided"
    assert not any("other recording" in reason for reason in reasons(found[0].diagnosis))


def test_the_picture_says_the_verdict_of_all(monkeypatch, tmp_path):
    drawn = []
    monkeypatch.setattr(
        "agent.cli.common.pictures.draw", lambda _, said, file: drawn.append((said.verdict, file))
    )
    given = []
    for k in range(4):
        one = answer(f"FIC101_{k}", k)
        given.append(replace(one, task=replace(one.task, picture=tmp_path / f"{k}.png" if k else None)))
    list(together(iter(given), [0] * 4))
    assert drawn == [("stiction", tmp_path / f"{k}.png") for k in (1, 2, 3)]
