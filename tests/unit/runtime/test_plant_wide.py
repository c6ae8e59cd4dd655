"""The running agent compares its loops: which are compared, which are not, and that it does so repeatedly."""

import asyncio

import numpy as np
import pytest

from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.plant_wide import MOST_LOOPS, PlantWide, newest_of
from tests.unit.runtime.loops import START, loop_settings, sample

N = 1200
PERIOD = 60.0


def loop(name, pv, last=N):
    pipeline = LoopPipeline(loop_settings(name, seconds=float(N)), InlineExecutor())
    for k in range(last):
        pipeline.window.push(sample("op", float(k), 50.0 - pv[k], loop=name), float(k))
        pipeline.window.push(sample("pv", float(k), 80.0 + pv[k], loop=name), float(k))
    return pipeline


@pytest.fixture(scope="module")
def waves():
    rng = np.random.default_rng(3)
    time = np.arange(N)
    wave = np.sign(np.sin(2 * np.pi * time / PERIOD))
    followed = np.roll(wave, 5) + 0.1 * rng.normal(size=N)
    return {
        "FIC1": wave + 0.1 * rng.normal(size=N),
        "FIC2": followed,
        "FIC3": 0.1 * rng.normal(size=N),
    }


async def test_loops_with_one_wave_are_a_group_and_others_are_not_in_it(waves):
    loops = {name: loop(name, pv) for name, pv in waves.items()}
    wide = PlantWide(loops, InlineExecutor(), lambda: START + N)
    assert wide.newest is None
    look = await wide.look()
    assert wide.newest is look
    assert (look.time, look.left_out) == (START + N, 0)
    (group,) = look.finding.groups
    assert {each.loop for each in group.suspects} == {"FIC1", "FIC2"}
    assert group.period == pytest.approx(PERIOD, rel=0.05)


async def test_a_loop_that_fell_silent_does_not_cut_the_time_of_the_others(waves):
    loops = {name: loop(name, pv) for name, pv in waves.items()} | {"OLD": loop("OLD", waves["FIC1"], N // 2)}
    look = await PlantWide(loops, InlineExecutor()).look()
    assert set(look.finding.compared) == set(waves)
    assert look.left_out == 1
    assert look.finding.seconds > 0.9 * N


async def test_no_more_loops_are_compared_than_stated_and_few_samples_are_none(waves):
    assert newest_of(loop("FIC1", waves["FIC1"], 10)) is None
    one = loop("FIC3", waves["FIC3"], 200)
    look = await PlantWide({f"L{k:03d}": one for k in range(MOST_LOOPS + 5)}, InlineExecutor()).look()
    assert len(look.finding.compared) <= MOST_LOOPS
    assert look.left_out >= 5


async def test_it_looks_again_and_again(waves):
    loops = {name: loop(name, pv) for name, pv in waves.items()}
    seen = []
    wide = PlantWide(loops, InlineExecutor(), lambda: float(len(seen)), every=0.01)
    work = asyncio.create_task(wide.run())
    try:
        async with asyncio.timeout(30):
            while len(seen) < 2:
                await asyncio.sleep(0.01)
                if wide.newest is not None and wide.newest not in seen:
                    seen.append(wide.newest)
    finally:
        work.cancel()
        await asyncio.wait({work})


async def test_without_loops_there_is_nothing_to_find():
    look = await PlantWide({}, InlineExecutor()).look()
    assert (look.finding.groups, look.left_out) == ((), 0)
