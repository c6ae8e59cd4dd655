"""The contour map as a picture: a panel a structure, its minima, and the estimate with its intervals."""

import io

import numpy as np
import pytest

from agent.analysis.quantify.valves.error_map import ErrorMap
from agent.analysis.results import IntervalEstimate, Quantification, StictionEstimate
from agent.plots.contour import contour_figure
from agent.units import FrictionBands

AXIS = np.arange(0.0, 10.5, 0.5)
F_S, F_D = np.meshgrid(AXIS, AXIS, indexing="ij")
INSIDE = (F_D <= F_S) & (F_S + F_D <= 10.0)


def valley(f_s, f_d):
    return np.where(INSIDE, 1.0 + (F_S - f_s) ** 2 + (F_D - f_d) ** 2, np.nan)


def a_map(*layers, kinds=("fopdt", "sopdt")):
    return ErrorMap(AXIS, AXIS, kinds, np.stack(layers))


ONE = a_map(valley(6.0, 1.0), 1.5 * valley(5.0, 2.0))


def answer(stiction):
    return Quantification("free_run", stiction, None, 91.0, 60.0, 16.0, "stiction")


def panels(figure):
    return [axes for axes in figure.axes if axes.get_xlabel() == "f_D (OP units)"]


def lines(axes):
    return {line.get_label(): (line.get_xdata()[0], line.get_ydata()[0]) for line in axes.get_lines()}


def test_a_panel_a_structure_with_its_minimum():
    figure = contour_figure("FIC101", ONE)
    first, second = panels(figure)
    assert lines(first) == {"least error of the panel": (1.0, 6.0)}
    assert lines(second) == {"least error of the panel": (2.0, 5.0)}
    assert first.get_title() == "first order: least error 1, minima 1"
    assert second.get_title() == "second order: least error 1.5, minima 1"
    assert figure.get_suptitle() == (
        "FIC101: least error at f_S = 6, f_D = 1 OP units; within 10 % of it one minimum, S = 7"
    )


def test_several_minima_are_named_and_marked():
    figure = contour_figure("A", a_map(np.fmin(valley(6.0, 1.0), 0.05 + valley(2.0, 1.0)), kinds=("fopdt",)))
    assert "within 10 % of it 2 minima, S from 3 to 7" in figure.get_suptitle()
    assert len(panels(figure)[0].get_lines()) == 2


def test_the_estimate_with_its_intervals():
    s, j = IntervalEstimate(7.0, 6.0, 8.0), IntervalEstimate(5.0, 1.0, 7.0)
    found = StictionEstimate(IntervalEstimate(6.0), IntervalEstimate(1.0), s, j)
    axes = panels(contour_figure("A", ONE, answer(found)))[0]
    assert lines(axes)["estimate of free_run"] == (1.0, 6.0)
    region = next(patch for patch in axes.patches if patch.get_label() == "90 % intervals of S and J")
    corners = region.get_xy()[:4].tolist()
    # (f_D, f_S) of S 6 to 8, J 1 to 7; J cannot exceed S
    assert corners == [[2.5, 3.5], [0.0, 6.0], [0.5, 7.5], [3.5, 4.5]]


def test_no_cross_where_nothing_sticks():
    assert set(lines(panels(contour_figure("A", ONE, answer(None)))[0])) == {"least error of the panel"}


def test_without_intervals_only_the_cross():
    axes = panels(contour_figure("A", ONE, answer(StictionEstimate.of(FrictionBands(6.0, 1.0)))))[0]
    assert set(lines(axes)) == {"least error of the panel", "estimate of free_run"}
    assert "90 % intervals of S and J" not in axes.get_legend_handles_labels()[1]


@pytest.mark.parametrize(
    "layers",
    [
        (valley(6.0, 1.0), np.where(INSIDE, np.inf, np.nan)),
        (np.where(INSIDE, 1.0, np.nan), np.where(INSIDE, 2000.0, np.nan)),
    ],
    ids=["no plausible process", "flat"],
)
def test_odd_maps_can_be_saved(layers):
    picture = io.BytesIO()
    contour_figure("A", a_map(*layers)).savefig(picture, format="png")
    assert picture.getvalue().startswith(b"\x89PNG")
