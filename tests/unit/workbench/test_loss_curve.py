"""A vessel that loses heat by the fourth power is found, and is the same one at another level of OP."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects.characteristic import Characteristic
from agent.physics.effects.loss_curve import LossCurve
from agent.physics.effects.pv_gain import PvGain
from agent.physics.effects.second_order import SecondOrder
from agent.workbench.session import Workbench
from simulators.parts.first_order import heated

ABSOLUTE, TAU, FINE, DELAY, NOISE = 40.0, 12.0, 20, 3, 0.05


def vessel(middle, seed):
    """Return a record in manual: OP steps about ``middle``; the vessel is the same."""
    rng = np.random.default_rng(seed)
    op = middle + np.repeat(rng.uniform(-8, 8, 30), 30)
    held = heated(np.repeat(op - 50, FINE), middle - 50.0, 1 / (FINE * TAU), ABSOLUTE)[FINE - 1 :: FINE]
    pv = np.append(np.full(DELAY, held[0]), held[:-DELAY])
    return LoopWindow("vessel", 0.0, 1.0, op, 100 + 2 * pv + rng.normal(0, NOISE, len(op)))


@pytest.fixture(scope="module")
def bench():
    rivals = (Characteristic(), PvGain(), LossCurve(), SecondOrder())
    found = Workbench(vessel(45.0, 1), validate=vessel(62.0, 2), effects=rivals)
    found.auto()
    return found


def test_it_is_named_and_leaves_noise(bench):
    base, last = bench.staircase()
    assert last.effects == ("loss_curve",)
    assert last.verdict.kind in {"confirmed", "family"}
    assert base.held_out.rmse > 20 * NOISE
    assert last.held_out.rmse < 2 * NOISE


def test_another_recording_at_another_level_has_its_gain_and_time_constant(bench):
    """The gain there is 0.7 of that in the record that was fitted."""
    base, last = bench.staircase()
    assert last.rmse_validation < 0.25 * base.rmse_validation


def test_the_level_is_reported_as_a_constant(bench):
    _, last = bench.staircase()
    level = next(each for each in last.parameters if each.name == "loss_curve.level")
    assert level.low == level.value == level.high
    assert not level.at_bound
    slope = next(each for each in last.parameters if each.name == "loss_curve.curvature")
    # Of losses by the fourth power: 3 over the temperature at the level, for a gain of one there.
    at = ABSOLUTE * (1 + 4 * (level.value - 50) / ABSOLUTE) ** 0.25
    assert slope.value == pytest.approx(3 / at * (ABSOLUTE / at) ** 3, rel=0.15)
