"""Bases whose response is PV itself: their predictions, and what acts on them."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases.heater import HeaterBase
from agent.physics.bases.lag_bases import Fopdt
from agent.physics.loop_model import LoopModel
from agent.workbench.record import bare_record
from agent.workbench.session import Workbench
from agent.workbench.session.auto_base import Predicted, far_likelier
from simulators.balances.nonlinear_plants import NONLINEAR, nonlinear_record

OP = 50 + 10 * np.repeat(np.random.default_rng(4).uniform(-1, 1, 20), 20)
HEATER = np.array([1.0, 0.6, 0.004, 0.002, 20.0, -273.0, 700.0])


def window(process, truth, seed):
    record = nonlinear_record(seed, process, truth)
    return LoopWindow(f"{process}-{truth}", 0.0, 1.0, record.op, record.pv), record.floor


def test_a_furnace_with_nothing_hidden_is_followed_to_its_floor():
    """With its surroundings less than half a span below the least PV it had nine floors."""
    seen, floor = window("heater", "none", 81001)
    bench = Workbench(seen, "heater")
    assert bench.step.held_out.rmse < 1.3 * np.sqrt(np.mean(floor**2))
    predicts, best = bench.step.predicts
    assert predicts.variance(best) < 0.5 * np.mean(floor**2)
    assert np.nanmax(np.abs(predicts.fit(best).pv - seen.pv)) < 0.1 * np.ptp(seen.pv)  # level and all
    assert not any(each.name == "gain" for each in bench.step.numbers)


def test_what_acts_on_a_balance_is_its_derivative():
    model = LoopModel(HeaterBase())
    layout = model.layout(bare_record(LoopWindow("x", 0.0, 1.0, OP, OP)).facts)
    moves = np.column_stack((np.arange(len(OP)) > 200, np.sin(np.arange(len(OP)))))
    both = [layout.response(OP + sign * 1e-4 * moves[:, 0], HEATER) for sign in (-1.0, 1.0)]
    found = layout.answers(OP, moves, HEATER)
    assert found[:, 0] == pytest.approx((both[1] - both[0]) / 2e-4, rel=1e-2, abs=1e-6)
    assert np.all(found[:201, 0] == 0.0)


def test_what_acts_on_a_linear_process_is_its_response():
    facts = bare_record(LoopWindow("x", 0.0, 1.0, OP, OP)).facts
    values, moves = np.array([3.0, 12.0]), np.column_stack((OP, OP**2))
    layout = LoopModel(Fopdt()).layout(facts)
    assert np.array_equal(layout.answers(OP, moves, values)[:, 1], layout.response(OP**2, values))


def test_a_larger_base_pays_for_its_numbers():
    rng = np.random.default_rng(1)
    new = np.append(np.full(30, np.nan), rng.standard_normal(500))
    price = 10.0 + 4 * np.log(500)
    for gained, likelier in ((price + 1, True), (price - 1, False)):
        better = Predicted(np.exp(-gained / 1000) * new, 9, 0.0)
        assert far_likelier(better, Predicted(new, 5, 0.0)) is likelier
    # Samples that one of them does not predict are left out.
    fewer = np.where(np.arange(530) < 280, np.nan, new)
    assert not far_likelier(Predicted(fewer, 5, 0.0), Predicted(new, 5, 0.0))


@pytest.mark.parametrize("process", NONLINEAR)
def test_the_same_seed_gives_the_same_plant(process):
    one, other = (nonlinear_record(81002, process, "saturation") for _ in range(2))
    assert np.array_equal(one.pv, other.pv)
    assert 0.0 < np.std(one.floor) < 0.5 * np.std(one.pv)


@pytest.mark.bench  # a minute or two of CPU
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("truth", ["load_step", "deadband"])
def test_what_a_furnace_hides_is_confirmed(truth):
    seen, floor = window("heater", truth, 81001)
    bench = Workbench(seen, "heater")
    bench.auto()
    assert bench.step.effects == (truth,)
    assert bench.step.held_out.rmse < 1.2 * np.sqrt(np.mean(floor**2))
