"""Pictures of the workbench and the report, from values."""

import math
import re
from html.parser import HTMLParser
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy import signal

from agent.plots.time_units import time_of
from agent.plots.workbench.candidates import candidates_figure
from agent.plots.workbench.contributions import contributions_figure
from agent.plots.workbench.correlations import correlations_figure
from agent.plots.workbench.overlay import fit_percent, overlay_figure
from agent.plots.workbench.report import report_html
from agent.plots.workbench.residual_panels import residual_panels_figure
from agent.plots.workbench.spectrum import spectrum_figure
from agent.plots.workbench.staircase import Stair, staircase_figure
from agent.workbench.comparison import not_testable
from agent.workbench.hypotheses import Candidate
from agent.workbench.residual.independence import independence
from agent.workbench.residual.line_spectrum import line_spectrum
from agent.workbench.residual.noise_floor import NoiseFloor
from agent.workbench.residual.where import Failure, where_it_fails
from agent.workbench.residual.whiteness import whiteness

N = 1000
RNG = np.random.default_rng(0)
OP = 5 * signal.sawtooth(2 * np.pi * np.arange(N) / 50, 0.5)
RESIDUAL = np.roll(OP**2 / 10, 1) + RNG.normal(size=N)
NOT_TESTABLE = not_testable("FIC<101>", "OP & PV stand still")


def labels(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_the_overlay_shows_the_fit_of_each_model_and_the_folds():
    pv = OP + 50
    pv[:10] = np.nan
    models = {"fopdt": OP + 51, "+ stiction": OP + 50}
    fold = np.repeat([0, 1, 2, -1], N // 4)
    figure = overlay_figure("FIC101", 1.0, pv, models, fold)
    upper, lower = figure.axes
    share = fit_percent(pv, models["fopdt"])
    assert share == pytest.approx(100 * (1 - 1 / np.std(OP[10:])))
    assert labels(upper) == ["PV measured", f"fopdt (fit {share:.1f} %)", "+ stiction (fit 100.0 %)"]
    assert [text.get_text() for text in upper.texts] == ["1", "2", "3"]
    np.testing.assert_allclose(lower.get_lines()[0].get_ydata()[10:], -1)


def test_contributions_have_one_panel_each():
    figure = contributions_figure("FIC101", 1.0, {"stiction": OP, "load_step": OP / 2})
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["stiction", "load step"]


def test_panels_say_which_axis_the_residual_follows():
    panels = where_it_fails(RESIDUAL, {"op_level": OP, "time": np.arange(N, dtype=float)}, 100, RNG)
    figure = residual_panels_figure("FIC101", panels)
    assert figure.get_suptitle() == "FIC101: the residual depends on op level"
    assert figure.axes[0].get_xlabel() == "op level (OP)"
    assert "no failure" in figure.axes[1].get_title(loc="left")
    none = residual_panels_figure("FIC101", [panels[1]])
    assert none.get_suptitle() == "FIC101: the residual depends on no axis beyond chance"


def test_long_titles_of_panels_do_not_run_into_each_other():
    flat = np.zeros(1), np.array([-1.0]), np.array([1.0])
    axes = ("op_rate", "travel_since_reversal", "oscillation_phase")
    figure = residual_panels_figure(
        "FIC101", [Failure(each, 0.15, 0.001, np.array([0.0, 1.0]), *flat) for each in axes]
    )
    FigureCanvasAgg(figure).draw()
    titles = [each._left_title.get_window_extent() for each in figure.axes]
    assert all(one.x1 < other.x0 for one, other in pairwise(titles))
    assert titles[-1].x1 < figure.bbox.x1


def test_correlations_and_what_could_not_be_computed():
    figure = correlations_figure("FIC101", whiteness(RESIDUAL), independence(RESIDUAL, OP))
    assert "p < 0.001" in figure.axes[0].get_title(loc="left")
    empty = correlations_figure("FIC101", None, None)
    assert all("too few samples" in axes.get_title(loc="left") for axes in empty.axes)


def test_lines_of_the_spectrum_say_where_they_come_from():
    found = line_spectrum(np.sin(2 * np.pi * np.arange(N) / 35) + RNG.normal(size=N) / 3, OP, 1.0)
    (axes,) = spectrum_figure("FIC101", found).axes
    assert labels(axes) == ["residual", "noise exceeds this in 1 %", "period 35 s: comes from outside"]


def test_the_staircase_falls_to_the_floor():
    stairs = [Stair("fopdt", 2.0, 1.8, 2.2), Stair("+ stiction", 0.5, 0.4, 0.6, validation=0.55)]
    (axes,) = staircase_figure("FIC101", stairs, NoiseFloor(0.3, 0.6)).axes
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["fopdt", "+ stiction"]
    assert [text.get_text() for text in axes.texts] == ["-75 %"]
    (alone,) = staircase_figure("FIC101", stairs[:1], NoiseFloor(0.3, 0.6)).axes
    assert not alone.texts
    assert set(labels(axes)) == {"noise floor interval", "held out, 90 % interval", "another recording"}


def test_a_rejected_candidate_is_not_coloured_as_one_that_counts():
    tried = [
        Candidate("rate_limit", "valve_speed", 95.0, 87.0, 97.0, 1.0, odds=90.0),
        Candidate("sinusoid", "disturbance", 40.0, 30.0, 50.0, 0.001, odds=math.inf, by_blocks=True),
        Candidate("saturation", "valve_limits", 27.0, 10.0, 40.0, 1.0, "far less likely", odds=20.0),
        Candidate("gain_change", "gain", 20.0, 10.0, 40.0, 0.01, odds=-2.0),
        Candidate("deadband", "valve_hysteresis", 0.1, -1.0, 1.0, 1.0, odds=12.0),
    ]
    counts, wave, *others = candidates_figure("FIC101", tried).axes[0].patches
    assert counts.get_facecolor() == wave.get_facecolor()
    assert all(each.get_facecolor() != counts.get_facecolor() for each in others)


def test_candidates_are_coloured_where_they_count():
    tried = [
        Candidate("stiction", "valve_hysteresis", 60.0, 50.0, 70.0, 0.001, odds=40.0),
        Candidate("load_step", "disturbance", -900.0, -2000.0, -1.0, 1.0),
    ]
    (axes,) = candidates_figure("FIC101", tried).axes
    first, second = axes.patches
    assert first.get_facecolor() != second.get_facecolor()
    assert (first.get_width(), second.get_width()) == (60.0, -20.0)
    said = [label.get_text() for label in axes.get_yticklabels()]
    assert said == ["stiction  (odds 1e9 to 1)", "load step  (no likelier with it)"]


class Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.sources = []

    def handle_starttag(self, tag, attrs):  # noqa: ARG002 - as it is called
        self.sources += [value for name, value in attrs if name in ("src", "href")]


def test_the_report_holds_its_pictures_and_nothing_from_outside():
    figure = Figure()
    figure.subplots().plot([1, 2])
    page = report_html(NOT_TESTABLE, {"overlay": figure})
    tags = Tags()
    tags.feed(page)
    assert len(tags.sources) == 1
    assert tags.sources[0].startswith("data:image/png;base64,")
    assert not re.search(r"https?://", page)
    assert "FIC&lt;101&gt;" in page
    assert "Not testable: OP &amp; PV stand still" in page


def test_time_is_drawn_in_the_unit_that_reads_best():
    assert [time_of(100, ts)[1] for ts in (1.0, 60.0, 600.0, 3600.0)] == ["s", "min", "h", "days"]
    assert time_of(3, 1800.0)[0].tolist() == [0.0, 30.0, 60.0]
