"""The picture of a loop holds what was measured and what the model says, and names both."""

import io
from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.diagnosis import Diagnosis
from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import CauseShare, Oscillation, Quantification, StictionEstimate
from agent.plots.fit import fit_figure
from agent.units import FrictionBands

T = np.arange(400)
WAVE = np.sin(2 * np.pi * T / 60)
WINDOW = LoopWindow("FIC101", 1.7e9, 2.0, op=50 + 5 * WAVE, pv=20 + WAVE, sp=np.full(400, 20.0))
FOUND = Quantification(
    quantifier="free_run",
    stiction=StictionEstimate.of(FrictionBands(2.0, 1.0)),
    process=None,
    free_run_percent=91.23,
    linear_percent=60.0,
    evidence=16.0,
    decision="stiction",
    model_pv=WINDOW.pv + 0.1,
    model_mv=WINDOW.op - 1,
)
DIAGNOSIS = Diagnosis(
    loop="FIC101",
    verdict="stiction",
    confidence=0.97,
    cause="stiction",
    causes=(CauseShare("stiction", 0.9),),
    stiction_class="dead_band_stick_slip",
    oscillation=Oscillation(detected=True, period=120.0, regularity=9.0),
    quantification=FOUND,
)


def labels(axes):
    return [line.get_label() for line in axes.get_lines()]


def test_measurement_and_model():
    figure = fit_figure(WINDOW, DIAGNOSIS)
    pv, op, plane = figure.axes
    assert labels(pv) == ["SP", "PV measured", "PV of the model (fit 91.2 %)"]  # the number of the text
    assert labels(op) == ["OP measured", "valve position of the model"]
    assert labels(plane) == ["measured", "model"]
    np.testing.assert_array_equal(plane.get_lines()[0].get_xdata(), WINDOW.op)
    np.testing.assert_array_equal(pv.get_lines()[2].get_ydata(), FOUND.model_pv)
    assert figure.get_suptitle() == "FIC101: stiction,  S = 3,  J = 1 OP units,  period 120 s"


def test_a_valve_that_follows_op_is_not_drawn():
    free = replace(DIAGNOSIS, quantification=replace(FOUND, model_mv=WINDOW.op))
    assert labels(fit_figure(WINDOW, free).axes[1]) == ["OP measured"]


def test_of_a_long_record_the_model_is_drawn_at_the_level_of_pv():
    n = 10_000
    wave = np.sin(2 * np.pi * np.arange(n) / 60)
    drift = np.linspace(0.0, 30.0, n)  # slower than the model explains
    day = replace(WINDOW, op=50 + 5 * wave, pv=20 + wave + drift, sp=None)
    long = replace(DIAGNOSIS, quantification=replace(FOUND, model_pv=20 + wave, model_mv=day.op - 1))
    measured, model = fit_figure(day, long).axes[0].get_lines()
    assert len(model.get_ydata()) < n
    assert model.get_label().startswith("PV of the model at the level of PV")
    assert np.mean(model.get_ydata() - measured.get_ydata()) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("ts", "unit"), [(1.0, "s"), (2.0, "min"), (60.0, "h"), (1000.0, "days")])
def test_time_in_a_unit_that_reads_well(ts, unit):
    figure = fit_figure(replace(WINDOW, ts=ts), DIAGNOSIS)
    assert figure.axes[1].get_xlabel().endswith(f"({unit})")


def test_without_model_only_the_measurement():
    nothing = replace(DIAGNOSIS, verdict="not_testable", quantification=None, oscillation=None)
    pv, op, plane = fit_figure(replace(WINDOW, sp=None), nothing).axes
    assert [labels(axes) for axes in (pv, op, plane)] == [["PV measured"], ["OP measured"], ["measured"]]


def test_a_record_of_gaps_can_still_be_saved():
    gaps = replace(WINDOW, op=np.full(400, np.nan), pv=np.full(400, np.nan))
    nothing = replace(DIAGNOSIS, verdict="not_testable", quantification=None, oscillation=None)
    picture = io.BytesIO()
    fit_figure(gaps, nothing).savefig(picture, format="png")
    assert picture.getvalue().startswith(b"\x89PNG")
