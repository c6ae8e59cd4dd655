"""Modes of controllers: the table, what users add to it, and stretches that are cut out."""

from __future__ import annotations

import numpy as np
import pytest

from agent.analysis.diagnose import diagnose
from agent.analysis.record.mode import automatic_share, is_automatic, unknown_modes, word_of
from agent.analysis.record.recording import LoopWindow
from agent.report.diagnosis_json import diagnosis_json
from agent.report.reasons import reasons

AUTOMATIC = [
    "AUTO",
    "Aut",
    "a",
    "CAS",
    "cas",
    "RCAS",
    " Automatik ",
    "1",
    "1.0",
    1.0,
    "AUTO/NORMAL",
    "CAS (2)",
]
MANUAL = ["MAN", " Man ", "Hand", "M", "manuell", "0", "0.0", 0.0, "IMAN", "O/S", "Man: tracking"]


@pytest.mark.parametrize("mode", AUTOMATIC)
def test_words_for_automatic(mode):
    assert is_automatic(mode) is True


@pytest.mark.parametrize("mode", MANUAL)
def test_words_for_manual(mode):
    assert is_automatic(mode) is False


@pytest.mark.parametrize("mode", ["PROG7", "", float("nan"), "77", "inf"])
def test_what_the_table_does_not_have(mode):
    assert is_automatic(mode) is None


def test_users_add_words_and_change_those_of_the_table():
    others = {word_of("PROG7"): True, word_of("2.0"): False}
    assert is_automatic("prog7", others) is True
    assert (is_automatic("2"), is_automatic(2.0, others)) == (True, False)


def test_a_mode_that_nobody_knows_is_not_automatic_and_one_that_is_absent_is_not_manual():
    np.testing.assert_array_equal(
        automatic_share(["AUTO", "Hand", "PROG7", " ", ""]), [1, 0, 0, np.nan, np.nan]
    )
    assert unknown_modes(["AUTO", "PROG7", "", "X", "PROG7"]) == ("PROG7", "X")


def test_what_was_not_automatic_is_cut_out_of_op_pv_and_mv():
    values, automatic = np.arange(40.0), np.arange(40) >= 10
    window = LoopWindow("L", 0.0, 1.0, values, values, values, values, automatic)
    for signal in (window.op, window.pv, window.mv):
        assert signal is not None
        assert np.isnan(signal[:10]).all()
        assert np.isfinite(signal[10:]).all()
    assert window.sp is not None
    assert np.isfinite(window.sp).all()


def test_the_share_in_manual_is_stated_and_a_step_there_changes_no_verdict():
    rng = np.random.default_rng(1)
    t = np.arange(1000)
    op = 50 + 3 * np.sin(t / 8) + 0.05 * rng.standard_normal(t.size)
    pv = 20 + 2 * np.sin(t / 8 - 1.2) + 0.05 * rng.standard_normal(t.size)
    automatic = (t < 400) | (t >= 600)
    stepped = np.where(automatic, op, 90.0)
    found = [
        diagnose(LoopWindow("L", 0.0, 1.0, each, pv, automatic=automatic, unknown_modes=("PROG7",)))
        for each in (op, stepped)
    ]
    assert diagnosis_json(found[0], "L.csv")["manual_percent"] == pytest.approx(20.0)
    assert "the loop was not in automatic for 20 % of the record; this was cut out and not used" in reasons(
        found[0]
    )
    assert any("mode PROG7" in each for each in reasons(found[0]))
    assert found[0].verdict == found[1].verdict
    assert found[0].probability == found[1].probability


def test_a_record_without_modes_states_no_share():
    wave = np.sin(np.arange(300) / 8)
    found = diagnose(LoopWindow("L", 0.0, 1.0, wave, wave, automatic=np.zeros(300, dtype=bool)))
    assert (found.verdict, found.gates) == ("not_testable", ("manual",))
    assert diagnosis_json(found, "L.csv")["manual_percent"] == 100.0
