"""Whose turn it is: quick calculations first, none waits for ever, slow ones leave a place."""

import asyncio
from dataclasses import replace

from agent.analysis.memory.outcome import OUTCOMES
from agent.analysis.memory.valve_memory import ValveMemory
from agent.runtime.loop.turns import LONGEST_PATIENCE, PATIENCE, Turns
from tests.unit.runtime.agents import FIVE, agent_of, judged, stream, virtual, worked
from tests.unit.runtime.fake_bus import FakeBus

QUICK, FIT = 0.05, 7.5


class Workers:
    """An executor in virtual time: a fit takes as long as its diagnosis says, all else is quick."""

    def __init__(self, places):
        self.turns = Turns(places)
        self.waits = {}
        """Loop -> longest time that one of its windows waited for a worker, s."""

    @property
    def queued(self):
        return self.turns.waiting

    async def run_in_turn(self, expected, work, worth=1.0):
        clock = asyncio.get_running_loop()
        due = clock.time()
        async with self.turns.turn(expected, worth):
            found = work()()
            loop = found.diagnosis.loop
            self.waits[loop] = max(self.waits.get(loop, 0.0), clock.time() - due)
            await asyncio.sleep(found.diagnosis.seconds or QUICK)
            return found


def slow(loops, seconds=FIT):
    """Diagnose those loops slowly, all others at once."""

    def diagnose(window, _seen=None):
        return replace(
            judged("stiction" if window.loop in loops else "no_stiction")(window),
            seconds=seconds if window.loop in loops else QUICK,
        )

    return diagnose


def test_quick_windows_pass_those_whose_fit_is_slow():
    async def scenario():
        turns, order = Turns(1), []

        async def one(name, expected):
            async with turns.turn(expected):
                order.append(name)
                await asyncio.sleep(expected or QUICK)

        first = asyncio.create_task(one("running", 1.0))
        await asyncio.sleep(0)
        others = [asyncio.create_task(one(f"slow{k}", FIT)) for k in range(3)]
        await asyncio.sleep(0.1)
        others += [asyncio.create_task(one(f"quick{k}", 0.0)) for k in range(3)]
        await asyncio.gather(first, *others)
        return order

    assert virtual(scenario()) == ["running", "quick0", "quick1", "quick2", "slow0", "slow1", "slow2"]


def test_of_fits_that_wait_the_one_whose_answer_is_worth_most_goes_first():
    async def scenario():
        turns, order = Turns(1), []

        async def one(name, worth):
            async with turns.turn(FIT, worth):
                order.append(name)
                await asyncio.sleep(FIT)

        names = {"running": 1.0, "certain": 0.1, "usual": 1.0, "doubt": 2.0}
        await asyncio.gather(*(one(*each) for each in names.items()))
        return order

    assert virtual(scenario()) == ["running", "doubt", "usual", "certain"]


def test_a_loop_near_the_threshold_is_fitted_before_those_far_from_it():
    """As the agent has it: what windows so far say of each valve decides whose fit is next."""
    certain, order, workers = FIVE[:-1], [], Workers(1)

    def diagnose(window, _seen=None):
        order.append(window.loop)
        return replace(judged("undecided")(window), seconds=FIT)

    bus = FakeBus(stream(FIVE, 200))
    agent = agent_of(bus, FIVE, diagnose, executor=workers, seconds=100.0, quantify="always")
    for loop, pipeline in agent.pipelines.items():
        known = {"against": 20.0} if loop in certain else {"fair": 1.0}
        pipeline.memory = ValveMemory(former=tuple(known.get(outcome, 0.0) for outcome in OUTCOMES))
    virtual(worked(agent, 200.0))
    assert order.index(FIVE[-1]) == 1  # the first one found a free worker
    assert set(order) == set(FIVE)


def test_a_slow_fit_is_served_though_quick_windows_never_end():
    async def scenario():
        turns, clock = Turns(1), asyncio.get_running_loop()
        served = clock.create_future()

        async def quick():
            while not served.done():
                async with turns.turn(0.0):
                    await asyncio.sleep(QUICK)

        async def fit():
            async with turns.turn(FIT):
                served.set_result(clock.time())

        began = clock.time()
        await asyncio.gather(*(quick() for _ in range(30)), fit())
        return served.result() - began

    waited = virtual(scenario())
    assert PATIENCE * FIT <= waited <= min(PATIENCE * FIT, LONGEST_PATIENCE) + 30 * QUICK + 1.0


def test_of_several_places_one_is_never_given_to_slow_fits():
    async def scenario():
        turns = Turns(2)

        async def fit():
            async with turns.turn(FIT):
                await asyncio.sleep(FIT)

        fits = [asyncio.create_task(fit()) for _ in range(5)]
        await asyncio.sleep(2 * PATIENCE * FIT / 20)
        clock = asyncio.get_running_loop()
        began = clock.time()
        async with turns.turn(0.0):
            waited = clock.time() - began
        queued = turns.waiting
        for each in fits:
            each.cancel()
        await asyncio.wait(fits)
        async with turns.turn(FIT):  # who was cancelled holds no place, waiting or not
            return waited, queued, turns.waiting

    waited, queued, left = virtual(scenario())
    assert waited == 0.0
    assert queued >= 1
    assert left == 0


def test_loops_with_slow_fits_do_not_hold_up_the_others():
    loops = tuple(f"FIC{k:03d}" for k in range(20))
    sticking = loops[:2]
    seen, workers = [], Workers(1)
    agent = agent_of(
        FakeBus(stream(loops, 1000)),
        loops,
        slow(sticking),
        seen,
        workers,
        seconds=100.0,
        hop=0.1,
        quantify="always",
    )
    status = virtual(worked(agent, 1000.0))
    judged_of = {loop: sum(each.loop == loop for each in seen) for loop in loops}
    due = (1000 - 100) // 10
    assert min(judged_of[loop] for loop in loops[2:]) >= due - 5
    assert min(judged_of[loop] for loop in sticking) >= 3
    # At most: what holds the only worker, every other slow fit once, and all others.
    most = len(sticking) * FIT + len(loops) * QUICK
    assert max(workers.waits[loop] for loop in loops[2:]) <= most
    assert {each.alarm.value for each in status if each.loop in sticking} == {"unacked_active"}
