"""The stiction indices that a loop has at hand while its samples come in."""

import pytest

from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.loop.workers import InlineExecutor
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate
from tests.unit.runtime.loops import loop_settings, sample

NAMES = {"he_curve_fit", "rossi_scali", "hagglund_shape", "singhal_salsbury"}


@pytest.mark.parametrize(("kind", "sticks"), [("stiction", True), ("sinusoid", False)])
def test_indices_follow_the_samples_over_overlapping_windows(kind, sticks):
    pipeline = LoopPipeline(loop_settings(seconds=400.0, hop=0.25), InlineExecutor())
    assert pipeline.indices == {}
    record = simulate(random_plant(2, kind))
    for k, (op, pv) in enumerate(zip(record.op.tolist(), record.pv.tolist(), strict=True)):
        for role, value in (("pv", pv), ("op", op)):
            pipeline.push(sample(role, float(k), value), float(k))
    assert set(pipeline.indices) == NAMES
    assert (pipeline.indices["he_curve_fit"] >= 0.6) is sticks
    assert (pipeline.indices["he_curve_fit"] <= 0.4) is not sticks


def test_an_integrating_loop_has_the_one_index_that_holds_there():
    pipeline = LoopPipeline(loop_settings(seconds=400.0, hop=0.25, integrating=True), InlineExecutor())
    record = simulate(random_plant(0, "sinusoid"))
    for k, (op, pv) in enumerate(zip(record.op.tolist(), record.pv.tolist(), strict=True)):
        for role, value in (("pv", pv), ("op", op)):
            pipeline.push(sample(role, float(k), value), float(k))
    assert set(pipeline.indices) == {"he_curve_fit"}
