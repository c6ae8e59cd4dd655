"""The contour map holds the answer of lee2008, and shows whether there is one minimum or several."""

from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.quantify.lee2008 import Lee2008
from agent.analysis.quantify.valves.error_map import ErrorMap, error_map
from agent.analysis.record.recording import LoopHints, LoopWindow
from tests.unit.quantify.loops import FIRST_ORDER, INTEGRATOR, SECOND_ORDER, loop, swinging_op

OP = swinging_op()
KNOWN = LoopHints(delay=4)


@pytest.mark.parametrize(
    ("process", "hints"),
    [
        (FIRST_ORDER, LoopHints()),
        (SECOND_ORDER, KNOWN),
        (FIRST_ORDER, replace(KNOWN, order=1)),
        (INTEGRATOR, replace(KNOWN, integrating=True)),
    ],
)
def test_the_best_cell_is_the_answer_of_lee2008(process, hints):
    window = loop(OP, 4.0, 1.0, process, hints=hints)
    errors, found = error_map(window), Lee2008("grid").quantify(window)
    kind, bands = errors.best
    assert (kind, bands.f_s, bands.f_d) == (
        found.process.kind,
        found.stiction.f_s.value,
        found.stiction.f_d.value,
    )
    assert np.nanmin(errors.error) == 1.0


def test_the_map_covers_the_triangle_of_the_paper():
    errors = error_map(loop(OP, 4.0, 1.0, hints=KNOWN), resolution=0.02)
    assert errors.kinds == ("fopdt", "sopdt")
    assert errors.error.shape == (2, 51, 51)
    np.testing.assert_allclose(errors.f_s, np.linspace(0.0, 20.0, 51), atol=1e-9)
    f_s, f_d = errors.f_s[:, None], errors.f_d[None, :]
    inside = (f_d <= f_s) & (f_s + f_d <= 20.0 + 1e-9)
    np.testing.assert_array_equal(np.isnan(errors.error), np.broadcast_to(~inside, (2, 51, 51)))


def test_a_free_valve_lies_at_the_origin():
    _, bands = error_map(loop(OP, 0.0, 0.0, hints=KNOWN)).best
    assert (bands.f_s, bands.f_d) == (0.0, 0.0)


@pytest.mark.parametrize(
    "window",
    [
        LoopWindow("still", 0.0, 1.0, np.full(600, 50.0), OP),
        LoopWindow("short", 0.0, 1.0, OP[:50], OP[:50]),
        loop(OP, 4.0, 1.0, hints=LoopHints(delay=600)),
    ],
    ids=["constant OP", "too short", "delay as long as the record"],
)
def test_there_is_no_map_of_what_cannot_be_fitted(window):
    assert error_map(window) is None


def drawn(*rows):
    """Return a map of two layers: one as drawn, f_S downwards, and one without a process."""
    layer = np.array(rows, dtype=float)
    axis = np.arange(len(layer), dtype=float)
    return ErrorMap(axis, axis, ("fopdt", "sopdt"), np.stack([layer, np.full_like(layer, np.inf)]))


NAN = np.nan
TWO = drawn(
    [9.0, NAN, NAN, NAN],
    [1.05, 9.0, NAN, NAN],
    [9.0, 9.0, 9.0, NAN],
    [1.0, 1.09, NAN, NAN],
)


def test_basins_are_connected_cells_as_good_as_the_best():
    assert [(each.f_s, each.f_d) for each in TWO.basins(0)] == [(3.0, 0.0), (1.0, 0.0)]
    assert TWO.s_of_basins(0) == (1.0, 4.0)


def test_cells_that_touch_by_a_corner_are_one_basin():
    assert len(drawn([1.0, NAN], [9.0, 1.0]).basins(0)) == 1


def test_a_layer_without_a_process_has_no_basin():
    assert TWO.basins(1) == ()
    assert TWO.best[0] == "fopdt"
