"""The population search on the shipped plants: the right valve, the same answer, bounded work."""

from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.quantify.free_run import FreeRun
from agent.analysis.quantify.free_run.found import SLIDES_BELOW
from agent.analysis.quantify.free_run.problem import QUICK, SLOW, in_spans
from agent.analysis.record.recording import LoopWindow
from agent.identify.objective import FOPDT, INTEGRATOR, J_RATIO, SOPDT, S
from agent.identify.search import cycle
from agent.identify.search import search as searching
from agent.identify.search.cycle import first_horizon, next_cycle, nothing, possible_of
from agent.identify.search.elites import J_CELL, S_CELL, elites_of, met_by
from agent.identify.search.linear import best_linear
from agent.identify.search.search import search, surprise
from agent.physics.valves.damped_stem import damped_stem
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate
from tests.unit.quantify.shipped_plants import op_span, plant, true_s

STICKS = ("fic101_stick_slip", "fic102_moderate_stiction")
"""S within a hundredth of the span: ten times the error that is typical (docs/methods/free_run.md)."""


@pytest.mark.parametrize("name", STICKS)
def test_a_sticking_valve_is_found(name):
    found = FreeRun().quantify(plant(name)[1])
    assert found.decision == "stiction"
    assert found.s.value == pytest.approx(true_s(name), abs=0.01 * op_span(name))
    assert found.s.low <= true_s(name) <= found.s.high


def test_a_sound_valve_is_not_accused():
    found = FreeRun().quantify(plant("fic103_healthy")[1])
    assert found.decision == "no_stiction"


def views(name="fic101_stick_slip"):
    window = plant(name)[1]
    return in_spans(window, SLOW), in_spans(window, QUICK)


def test_a_search_gives_the_same_answer_twice():
    one, other = search(views()), search(views())
    np.testing.assert_array_equal(one.searched.finalists.candidates, other.searched.finalists.candidates)
    assert one.work == other.work
    assert one.ended in {"white", "agreed"}


def test_a_small_budget_ends_a_search_after_its_first_turn(monkeypatch):
    monkeypatch.setattr(searching, "BUDGET", 1.0)
    monkeypatch.setattr(cycle, "WHITE", 0.0)
    assert search(views()).ended == "spent"


@pytest.mark.parametrize("missing", [False, True])
def test_where_no_valve_explains_more_than_none_the_first_island_ends_a_search_unless_a_block_is_missing(
    missing,
):
    record = simulate(random_plant(83100, "sinusoid"))
    view = in_spans(LoopWindow("x", 0.0, 1.0, record.op, record.pv), SLOW)
    if missing:
        weight = view.weight.copy()
        weight[len(weight) // 2] = 0.0
        view = view._replace(weight=weight)
    worth = best_linear(view, (FOPDT, SOPDT)).error / SLIDES_BELOW
    found = next_cycle(nothing(), view, (FOPDT, SOPDT), worth)
    assert found.ended == (None if missing else "explains_little")


def test_views_that_find_the_same_valve_end_a_search_that_leaves_no_white_noise(monkeypatch):
    monkeypatch.setattr(cycle, "WHITE", 0.0)
    monkeypatch.setattr(searching, "SAME_J", 0.2)  # this record says little of the jump
    found = search(views())
    assert found.ended == "agreed"
    assert found.searched.finalists.candidates[0][S] == pytest.approx(
        true_s("fic101_stick_slip") / op_span("fic101_stick_slip"), abs=0.01
    )


def test_a_load_that_wanders_makes_the_quick_view_likelier_and_white_noise_the_slow_one():
    op = plant("fic101_stick_slip")[1].op
    position = damped_stem(op, 1.5, 0.5, op[0], 0.01, 0.01, 1e-8)
    rng = np.random.default_rng(3)
    white = 0.05 * rng.normal(size=op.size)
    chosen = []
    for load in (white, np.cumsum(white)):
        window = LoopWindow("x", 0.0, 1.0, op, position + load)
        both = in_spans(window, SLOW), in_spans(window, QUICK)
        found = [next_cycle(nothing(), view, (FOPDT,)) for view in both]
        chosen.append([surprise(found[0], view) for view in both])
    assert chosen[0][0] < chosen[0][1]
    assert chosen[1][1] < chosen[1][0]


def test_a_cycle_around_nothing_is_an_island():
    view = views()[0]
    before = replace(nothing(), cycles=1)
    island, around = (next_cycle(before, view, (FOPDT,), around=each) for each in (None, before.finalists))
    np.testing.assert_array_equal(around.finalists.costs, island.finalists.costs)


def test_structures_that_are_not_possible_are_not_found():
    found = search(views(), (SOPDT,)).searched.finalists
    assert set(found.structures.tolist()) == {SOPDT}


def test_elites_are_the_best_of_their_cells_and_include_the_best():
    problem = views()[0]
    searched = next_cycle(nothing(), problem)
    models = elites_of(met_by(searched, problem), problem, possible_of((FOPDT, SOPDT, INTEGRATOR)))
    assert np.all(np.diff(models.costs) >= 0)
    assert models.costs[0] <= searched.finalists.costs[0]
    s = models.candidates[:, S]
    cells = zip(np.floor(s / S_CELL), np.floor(s * models.candidates[:, J_RATIO] / J_CELL), strict=True)
    assert len(set(cells)) == len(s)


@pytest.mark.parametrize("span", [1e-3, 1e4])
def test_a_record_in_other_units_is_the_same_problem(span):
    window = plant("fic101_stick_slip")[1]
    other = LoopWindow("x", 0.0, window.ts, 7.0 + span * window.op, -3.0 + span * window.pv)
    one, two = in_spans(window), in_spans(other)
    np.testing.assert_array_equal(one.op, two.op)
    np.testing.assert_allclose(one.pv, two.pv, atol=1e-12)


def test_few_periods_are_looked_at_by_half():
    problem = in_spans(plant("fic101_stick_slip")[1])
    few = problem._replace(period=problem.op.size / 8.0, quiet=0)
    assert first_horizon(few) == pytest.approx(4.0)


def test_what_moves_not_poses_no_problem():
    flat = LoopWindow("x", 0.0, 1.0, np.full(300, 50.0), np.random.default_rng(0).normal(size=300))
    assert "not move" in in_spans(flat)
    assert FreeRun().quantify(flat).failure is not None
