"""The daemon in virtual time: hours of five loops in seconds, with all that goes wrong on a bus."""

import asyncio
import contextlib
import gc
import random
import tracemalloc

import pytest

from agent.alarms import State
from agent.runtime.intake.window import CLOCK_SET_BACK
from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.wiring import TOGETHER
from agent.settings import AlarmSettings
from tests.unit.runtime.agents import FIVE, agent_of, judged, stream, swinging, virtual, worked
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import START, loop_settings, sample


def test_twelve_minutes_of_five_loops():
    bus, seen = FakeBus(stream(FIVE, 700)), []
    status = virtual(worked(agent_of(bus, FIVE, seen=seen), 700.5))
    assert [s.loop for s in status] == list(FIVE)
    assert {s.samples for s in status} == {1400}
    assert {s.gaps for s in status} == {0}
    assert {s.alarm for s in status} == {State.UNACKED_ACTIVE}
    # The first window is full after 400 samples, and one is due every 100 from then on.
    assert len(seen) == 5 * (1 + (700 - 400) // 100)
    assert bus.open == 0


def test_data_age_is_that_of_the_newest_sample():
    status = virtual(worked(agent_of(FakeBus(stream(FIVE, 100))), 130.0))
    assert status[0].data_age == pytest.approx(31.0)


def test_the_alarm_comes_and_goes_with_its_delays():
    bus, verdicts = FakeBus(stream(["FIC101"], 3600)), ["stiction"] * 4 + ["no_stiction"] * 4

    def diagnose(window, _seen=None):
        return judged(verdicts.pop(0) if verdicts else "undecided")(window)

    alarm = AlarmSettings(on_delay=3, off_delay=2)
    virtual(worked(agent_of(bus, diagnose=diagnose, alarm=alarm), 3000.0))
    events = [p for p in bus.published if p.kind == "event"]
    assert [p.fields["state"] for p in events] == ["unacked_active", "returned_unacked"]
    assert [p.fields["active"] for p in events] == [True, False]
    assert {p.subject for p in bus.published} == {"FIC101"}
    assert len({p.fields["id"] for p in events}) == 1
    states = [p.fields["active"] for p in bus.published if p.kind == "state"]
    assert states[:7] == [False, False, True, True, True, False, False]


def test_a_loop_at_rest_is_not_handed_to_the_workers():
    noise = random.Random(1)

    def source(_):
        for t in range(1000):
            yield sample("pv", t, 50 + noise.random() / 10)
            yield sample("op", t, 50 + noise.random() / 10)
            yield 1.0

    seen = []

    def diagnose(window, _seen=None):
        pytest.fail(f"a full diagnosis of {window.loop} at rest")

    status = virtual(worked(agent_of(FakeBus(source), diagnose=diagnose, seen=seen), 1000.0))
    assert {d.verdict for d in seen} == {"no_stiction"}
    assert {d.cause for d in seen} == {"no_oscillation"}
    assert status[0].alarm is State.NORMAL


def test_a_diagnosis_that_fails_does_not_end_its_loop(caplog):
    seen, calls = [], []

    def diagnose(window, _seen=None):
        calls.append(window)
        if len(calls) == 1:
            raise MemoryError
        return judged()(window)

    agent = agent_of(FakeBus(stream(["FIC101"], 700)), diagnose=diagnose, seen=seen)
    virtual(worked(agent, 700.0))
    assert len(calls) == 4
    assert len(seen) == 3
    assert agent.health["FIC101"].faults == 1
    assert "loop FIC101 failed" in caplog.text
    assert (agent.health["FIC101"].problem, agent.health["FIC101"].up) == ("", True)  # and works again


class SlowExecutor:
    """Takes its time, as a pool does."""

    async def run_in_turn(self, expected, work, _worth=1.0):
        calculation = work()
        await asyncio.sleep(240.0 if expected else 0.0)
        return calculation()


class BusyExecutor:
    """Has its only worker free for a fit now and then."""

    async def run_in_turn(self, expected, work, _worth=1.0):
        await asyncio.sleep(250.0 if expected else 0.0)
        return work()()


def test_who_waits_for_a_worker_has_the_newest_window_judged():
    ends = []

    def diagnose(window, _seen=None):
        ends.append(window.time[-1] - START)
        return judged()(window)

    agent = agent_of(FakeBus(stream(["FIC101"], 1200)), diagnose=diagnose, executor=BusyExecutor())
    virtual(worked(agent, 1200.0))
    assert ends == [599.0, 899.0]


def test_a_source_whose_clock_races_begins_no_more_than_a_diagnosis_a_second():
    begun = []

    def diagnose(window, _seen=None):
        begun.append(asyncio.get_running_loop().time())
        return judged()(window)

    # 1000 s of the source each 0.25 s: ten windows come due in that time.
    racing = agent_of(FakeBus(stream(["FIC101"], 100_000, step=0.25 / 1000)), diagnose=diagnose)
    virtual(worked(racing, 4.0))
    assert 5 <= len(begun) <= 9  # of some 160


def test_a_loop_has_one_diagnosis_at_a_time_and_the_newest_window_is_next():
    seen = []
    ends = []

    def diagnose(window, _seen=None):
        ends.append(window.time[-1] - START)
        return judged()(window)

    agent = agent_of(FakeBus(stream(["FIC101"], 1200)), diagnose=diagnose, seen=seen, executor=SlowExecutor())
    virtual(worked(agent, 1200.0))
    assert ends == [399.0, 599.0, 799.0]
    assert agent._pipelines["FIC101"].superseded > 0


class LateExecutor(InlineExecutor):
    """A worker is free after 100 s."""

    async def run_in_turn(self, _expected, work, _worth=1.0):
        await asyncio.sleep(100.0)
        return work()()


def test_a_window_whose_clock_was_set_back_while_it_waited_is_not_judged():
    async def scenario():
        ends = []
        pipeline = LoopPipeline(
            loop_settings(seconds=40.0, quantify="always"),
            LateExecutor(),
            diagnose=lambda window, _seen=None: ends.append(window.time[-1] - START) or judged()(window),
        )
        work = asyncio.create_task(pipeline.run())
        for times in (range(40), range(-5000, -5000 + CLOCK_SET_BACK)):
            for t in times:
                for each in swinging("FIC101", float(t)):
                    pipeline.push(each, 0.0)
            await asyncio.sleep(1.0)
        await asyncio.sleep(200.0)
        assert (ends, pipeline.superseded, pipeline.busy) == ([], 1, False)
        for t in range(-5000 + CLOCK_SET_BACK, -5000 + CLOCK_SET_BACK + 40):
            for each in swinging("FIC101", float(t)):
                pipeline.push(each, 0.0)
        await asyncio.sleep(200.0)
        work.cancel()
        return ends

    assert len(virtual(scenario())) == 1


def test_loops_of_a_large_plant_that_begin_together_come_due_over_a_hop():
    names = tuple(f"FIC{k:04d}" for k in range(3 * TOGETHER))
    agent = agent_of(FakeBus([]), loops=names)
    staggers = [agent.pipelines[name].window._stagger for name in names]
    assert staggers == sorted(staggers)
    assert [staggers.count(each) for each in dict.fromkeys(staggers)] == [TOGETHER] * 3
    assert staggers[0] == 0.0
    assert staggers[-1] < 1.0
    assert {agent_of(FakeBus([])).pipelines["FIC101"].window._stagger} == {0.0}


def test_it_ends_in_time_though_a_peer_does_not_let_go():
    bus = FakeBus(stream(["FIC101"], 1000))
    bus.close_takes = 1000.0

    async def scenario():
        task = asyncio.create_task(agent_of(bus).run())
        await asyncio.sleep(10.0)
        start = asyncio.get_running_loop().time()
        task.cancel()
        await asyncio.wait({task})
        assert task.cancelled()
        return asyncio.get_running_loop().time() - start

    assert virtual(scenario()) < 5.0


class DeafBus(FakeBus):
    """Keeps a cancellation to itself when a sample comes, as wait_for of Python 3.11 does."""

    async def samples(self):
        for t in range(10_000):
            with contextlib.suppress(asyncio.CancelledError):
                await asyncio.sleep(1.0)
            yield swinging("FIC101", t)[0]


def test_it_ends_though_a_library_swallows_the_cancellation():
    virtual(worked(agent_of(DeafBus(None)), 100.5))


def test_it_knows_the_newest_source_time_of_a_loop():
    agent = agent_of(FakeBus(stream(["FIC101"], 100)))
    assert agent.newest("FIC101") is None
    virtual(worked(agent, 200.0))
    assert agent.newest("FIC101") >= START + 99


@pytest.mark.bench  # tests/faults/test_soak.py holds the short form
def test_memory_is_flat_after_warm_up():
    bus = FakeBus(stream(["FIC101"], 8000, step=0.5))
    agent = agent_of(bus, diagnose=judged("no_stiction"))

    def in_use():
        bus.published.clear()  # the test's bus keeps what it is sent
        gc.collect()  # detectors leave reference cycles of numpy and scipy behind, which wait for it
        return tracemalloc.get_traced_memory()[0]

    async def scenario():
        task = asyncio.create_task(agent.run())
        await asyncio.sleep(2000.0)  # the interpreter's free lists fill up, too
        tracemalloc.start()
        before = in_use()
        await asyncio.sleep(1900.0)
        grown = in_use() - before
        tracemalloc.stop()
        task.cancel()
        await asyncio.wait({task})
        return grown

    assert virtual(scenario()) < 100_000  # one window of two roles; 3800 samples would be much more
