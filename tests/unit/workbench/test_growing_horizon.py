"""The evolution strategy that follows valves from the first part of a record to all of it."""

from dataclasses import dataclass

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects.stiction import Stiction
from agent.physics.loop_model import LoopModel
from agent.workbench import growing_horizon
from agent.workbench.fit import fit
from agent.workbench.growing_horizon import KEPT, SAME, Generation, followed, over_first
from agent.workbench.prediction_search import predictor
from agent.workbench.projection import target_of
from agent.workbench.record import bare_record
from agent.workbench.search import objective_of, whitened
from simulators.draws.hidden_effects import hidden_effect_plant


@pytest.fixture(scope="module")
def posed():
    """A loop that sticks, with a gap, behind the filter of what the base leaves."""
    plant = hidden_effect_plant(5331, "stiction")
    pv = plant.pv.copy()
    pv[300:340] = np.nan
    record = bare_record(LoopWindow("loop", 0.0, 1.0, plant.op, pv))
    predicts, _ = predictor(fit(LoopModel(Fopdt()), record, record.weight), record)
    model = LoopModel(Fopdt(), (Stiction(),))
    plain = objective_of(model, record, target_of(record, record.weight, linear=True))
    return whitened(plain, predicts.noise)


@pytest.mark.parametrize("part", [1 / 8, 1 / 4, 1 / 2, 1.0])
def test_a_part_holds_its_share_of_the_samples_that_count(posed, part):
    first = over_first(posed, part)
    count = np.count_nonzero(posed.target.weight)
    assert np.count_nonzero(first.target.weight) == pytest.approx(part * count, abs=2)
    np.testing.assert_array_equal(first.record.op, posed.record.op[: len(first.record)])


def test_the_whole_part_is_the_objective_itself(posed):
    at = np.full(len(posed.space), 0.3)
    assert over_first(posed, 1.0).error(at) == pytest.approx(posed.error(at), rel=1e-9)


def test_what_follows_a_part_does_not_move_its_error(posed):
    at = np.full(len(posed.space), 0.3)
    before = over_first(posed, 0.25)
    record = posed.record
    pv = np.where(np.arange(len(record)) < len(before.record), record.pv, 0.0)
    elsewhere = type(record)(record.loop, record.op, pv, record.weight, record.facts)
    target = target_of(elsewhere, elsewhere.weight, linear=True)
    other = whitened(objective_of(posed.model, elsewhere, target), posed.noise)
    assert over_first(other, 0.25).error(at) == before.error(at)


@dataclass(frozen=True)
class Stairs:
    """A bowl whose error goes in steps, as that of a valve does; the third coordinate means nothing."""

    bottom: np.ndarray

    def error(self, at):
        away = np.abs(at[:2] - self.bottom)
        return 1.0 + float(np.sum(np.floor(200 * away)) + 5 * np.sum(away))


@pytest.fixture
def stairs(monkeypatch):
    monkeypatch.setattr(growing_horizon, "over_first", lambda objective, _: objective)
    return Stairs(np.array([0.31, 0.77]))


def test_steps_of_the_error_do_not_hold_it_up(stairs):
    points = np.random.default_rng(5).random((400, 3))
    found = followed(stairs, points, np.full(3, 0.5))
    assert np.all(np.abs(found[0, :2] - stairs.bottom) < 0.005)


def test_points_that_differ_only_where_it_means_nothing_are_one(stairs):
    found = followed(stairs, np.random.default_rng(5).random((400, 3)), np.full(3, 0.5))
    errors = np.array([stairs.error(each) for each in found])
    assert 1 < len(found) <= KEPT
    assert np.all(np.diff(errors) > SAME * errors[:-1])


def test_one_record_has_one_answer(stairs):
    points = np.random.default_rng(5).random((100, 3))
    twice = [followed(stairs, points, np.full(3, 0.5)) for _ in range(2)]
    np.testing.assert_array_equal(*twice)


def test_what_is_tried_as_well_is_not_lost(stairs):
    at = np.append(stairs.bottom, 0.5)
    assert stairs.error(followed(stairs, np.ones((8, 3)), at)[0]) == stairs.error(at)


def test_children_stay_in_the_cube_and_move_one_to_three_values(monkeypatch):
    monkeypatch.setattr(growing_horizon, "SMALLEST", 0.0)
    parents = np.random.default_rng(2).random((6, 8))
    children = growing_horizon._children(parents, Generation(0.5, 6, 50), 0.0, np.random.default_rng(1))
    assert children.shape == (300, 8)
    assert children.min() >= 0
    assert children.max() <= 1
    moved = (children != np.repeat(parents, 50, axis=0)).sum(axis=1)
    assert set(moved.tolist()) == {1, 2, 3}
