"""A curve of another shape, or at another place, is more than the effect of the library that it resembles."""

import numpy as np

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import BASES
from agent.physics.effects import EFFECTS
from agent.workbench.checks.unnamed_curve import AT_SENSOR, AT_VALVE, BETTER, CURVES, MOST, curves_beside
from agent.workbench.session import Workbench
from simulators.draws.hidden_effects import hidden_effect_plant

OP = np.linspace(40.0, 60.0, 101)


def test_a_curve_has_pieces_of_these_slopes_and_is_straight_at_its_null():
    np.testing.assert_allclose(AT_VALVE.apply(OP, np.zeros(4), 1.0), OP)
    curved = AT_VALVE.apply(OP, np.array([-MOST, 0.0, 0.5, 1.0]), 1.0)
    slopes = np.diff(curved)[::20] / 0.2
    np.testing.assert_allclose(slopes, np.exp([-MOST, 0.0, 0.0, 0.5, 1.0]))
    assert curved[0] == OP[0]


def test_only_curves_have_such_rivals_and_only_on_a_process_with_a_gain():
    for family in {each.family for each in EFFECTS}:
        for base in BASES:
            found = [each for each, *_ in curves_beside(family, base)]
            assert found == ([AT_VALVE, AT_SENSOR] if family in CURVES and base.linear else [])


def test_a_curve_in_place_of_one_that_nobody_named_is_suggested():
    """A vessel whose losses grow with temperature, and a library that has curves of valves only."""
    plant = hidden_effect_plant(91390, "pv_gain")
    window = LoopWindow("loop", 0.0, plant.scenario.ts, plant.op, plant.pv, plant.sp)
    others = {each.name for each in EFFECTS} - {"split_range", "pv_gain"}
    decision = Workbench(window, without={*others, "pv_gain"}).candidates()
    assert (decision.kind, decision.effect) == ("suggested", "split_range")
    assert BETTER in decision.lacks
    named = Workbench(window, without=others).candidates()
    assert (named.kind, named.effect) == ("confirmed", "pv_gain")
