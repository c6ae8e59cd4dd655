"""The profile as a picture: p, delay and J over S, with what the interval leaves shaded."""

from dataclasses import replace

import numpy as np

from agent.analysis.results import IntervalEstimate, Profile
from agent.plots.profile import profile_figure

S = np.linspace(1.0, 9.0, 81)
P = np.exp(-40.0 * np.minimum((S - 3.0) ** 2, 0.02 + (S - 7.0) ** 2))
PROFILE = Profile(s=S, p=P, delay=20.0 - 2 * S, j=S / 2, limit=0.1)


def shaded(axes):
    """S ends of the shaded stretches."""
    stretches = [patch.get_extents().transformed(axes.transData.inverted()) for patch in axes.patches]
    return [(round(box.x0, 6), round(box.x1, 6)) for box in stretches]


def test_the_curves_over_s():
    upper, delay, j = profile_figure("FIC101", PROFILE).axes
    for axes, values in ((upper, P), (delay, PROFILE.delay), (j, PROFILE.j)):
        np.testing.assert_array_equal(axes.get_lines()[0].get_xdata(), S)
        assert any(np.array_equal(line.get_ydata(), values) for line in axes.get_lines())
    assert [axes.get_ylabel() for axes in (upper, delay, j)] == [
        "p of the best model",
        "delay (s)",
        "J (OP units)",
    ]
    assert upper.get_ylim()[1] > P.max()


def test_each_basin_is_shaded_and_marked():
    figure = profile_figure("FIC101", PROFILE, IntervalEstimate(3.0, 2.71, 7.23))
    for axes, values in zip(figure.axes, (P, PROFILE.delay, PROFILE.j), strict=True):
        assert shaded(axes) == [(2.8, 3.2), (6.9, 7.1)]
        marks = next(line for line in axes.get_lines() if line.get_label() == "best of a basin")
        np.testing.assert_allclose(marks.get_xdata(), [3.0, 7.0])
        np.testing.assert_array_equal(marks.get_ydata(), values[[20, 60]])
    assert figure.get_suptitle() == "FIC101: S = 3 (2.71 to 7.23) OP units, 2 basins"


def test_a_curve_that_nowhere_reaches_the_limit():
    figure = profile_figure("FIC101", replace(PROFILE, p=0.05 * P))
    assert figure.get_suptitle() == "FIC101: no S within the interval"
    assert [shaded(axes) for axes in figure.axes] == [[], [], []]
