from dataclasses import replace

import pytest

from agent.analysis.quantify.jelali2008 import Jelali2008
from agent.analysis.record.recording import LoopHints
from agent.physics.valves.two_state import two_state
from tests.unit.quantify.loops import SECOND_ORDER, loop, swinging_op

OP = swinging_op()
EACH = pytest.mark.parametrize("search", ["genetic", "pattern"])


@EACH
def test_with_its_delay_known_a_stick_slip_valve_comes_back(search):
    window = loop(OP, 6.0, 0.0, SECOND_ORDER, noise=0.0, hints=LoopHints(delay=4), valve=two_state)
    found = Jelali2008(search).quantify(window)
    assert found.decision == "stiction"
    assert found.stiction.s.value == pytest.approx(6.0, abs=0.3)
    assert found.stiction.j.value == pytest.approx(6.0, abs=0.6)
    assert found.process.kind == "sopdt"


@EACH
def test_the_process_is_of_second_order_unless_the_engineer_says_otherwise(search):
    window = loop(OP, 6.0, 0.0, valve=two_state)
    assert Jelali2008(search).quantify(window).process.kind == "sopdt"
    assert Jelali2008(search).quantify(window.with_hints(LoopHints(order=1))).process.kind == "fopdt"


@EACH
def test_the_delay_is_fixed_before_the_search(search):
    window = loop(OP, 6.0, 0.0, hints=LoopHints(delay=5), valve=two_state)
    assert Jelali2008(search).quantify(window).process.delay == 5 * window.ts


@EACH
def test_without_an_ellipse_the_search_starts_elsewhere(search):
    window = loop(OP, 0.0, 0.0)
    found = Jelali2008(search).quantify(replace(window, pv=2 * window.op))
    assert found.decision in ("no_stiction", "not_applicable")
