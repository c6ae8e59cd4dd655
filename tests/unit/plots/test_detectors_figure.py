"""The picture of the detectors: a panel for each that saw something, titled by what it says."""

import numpy as np
import pytest

from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import MethodResult
from agent.analysis.stiction import DETECTORS
from agent.plots.detectors import PICTURES, detectors_figure
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate


@pytest.fixture(scope="module")
def results():
    record = simulate(random_plant(4, "stiction"))
    window = LoopWindow("FIC101", 0.0, 1.0, record.op, record.pv, record.sp, record.mv)
    oscillation = detect_oscillation(window)
    return {each.name: each.detect(window, oscillation) for each in DETECTORS}


def test_every_detector_has_a_picture():
    assert set(PICTURES) == {each.name for each in DETECTORS}


def test_a_panel_for_each_that_saw_something(results):
    figure = detectors_figure("FIC101", results)
    seen = [name for name, result in results.items() if result.seen is not None]
    assert seen
    assert [axes.get_title(loc="left").split(":")[0] for axes in figure.axes] == seen
    assert all(axes.has_data() for axes in figure.axes)
    assert all(axes.get_xlabel() and axes.get_ylabel() for axes in figure.axes)
    figure.draw_without_rendering()


def test_a_day_is_no_solid_block():
    phase = 2 * np.pi * np.arange(20_000) / 50
    op, stem = np.abs(2 * (phase / np.pi % 2 - 1)), np.sign(np.sin(phase))
    window = LoopWindow("FIC101", 0.0, 1.0, op, stem, None, stem)
    oscillation = detect_oscillation(window)
    for name in ("kano_a", "kano_b", "yamashita"):
        (detector,) = (each for each in DETECTORS if each.name == name)
        result = detector.detect(window, oscillation)
        assert result.seen is not None
        (axes,) = detectors_figure("FIC101", {name: result}).axes
        longest = max(len(line.get_xdata()) for line in axes.get_lines())
        assert longest <= 0.25 * len(window), name


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_no_empty_panel_is_left(results, count, monkeypatch):
    one = results["horch_ccf"]
    names = [f"method_{k}" for k in range(count)]
    for name in names:
        monkeypatch.setitem(PICTURES, name, PICTURES["horch_ccf"])
    assert len(detectors_figure("FIC101", dict.fromkeys(names, one)).axes) == count


def test_the_title_shows_verdict_and_index():
    seen = DETECTORS[0].detect(*_quarter_period_apart()).seen
    result = MethodResult("no_stiction", 0.123456, "why", seen)
    figure = detectors_figure("FIC101", {"horch_ccf": result})
    assert figure.axes[0].get_title(loc="left") == "horch_ccf: no stiction, index 0.123"
    assert figure.get_suptitle() == "FIC101: measurements of the detectors"


def test_nothing_to_draw():
    nothing_seen = MethodResult("not_applicable", None, "too short")
    of_the_model = MethodResult("stiction", 3.0, "", object())
    assert detectors_figure("FIC101", {"horch_ccf": nothing_seen, "free_run": of_the_model}) is None


def _quarter_period_apart():
    phase = 2 * np.pi * np.arange(500) / 50
    window = LoopWindow("FIC101", 0.0, 1.0, np.sin(phase), np.cos(phase))
    return window, detect_oscillation(window)
