"""The daemon in virtual time: hours of five loops in seconds, with all that goes wrong on a bus."""

import asyncio
import contextlib
import gc
import logging
import math
import random
import tracemalloc
from contextlib import asynccontextmanager

import async_solipsism
import pytest

from agent.alarms import State
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.results import Oscillation
from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import AgentSettings, AlarmSettings, ConnectionSettings, Settings
from connectors.base import AccessDeniedError, ConnectionLostError, RefusedError
from connectors.options import Options, Target
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import START, loop_settings, sample

FIVE = tuple(f"FIC10{k}" for k in range(1, 6))


def virtual(coroutine):
    """Run in virtual time."""
    with asyncio.Runner(loop_factory=async_solipsism.EventLoop) as runner:
        return runner.run(coroutine)


def swinging(loop, t):
    """PV and OP of a loop that oscillates with a period of 50 s."""
    return [
        sample("pv", t, 50 + 5 * math.sin(t / 8), loop=loop),
        sample("op", t, 50 - 5 * math.cos(t / 8), loop=loop),
    ]


def stream(loops, seconds, step=1.0):
    def source(session):
        for k in range(int(seconds)):
            for loop in loops:
                yield from swinging(loop, session * seconds + k)
            yield step

    return source


def judged(verdict="stiction"):
    def diagnose(window, _seen=None):
        return Diagnosis(
            loop=window.loop,
            verdict=verdict,
            confidence=1.0,
            cause="undecided",
            causes=(),
            stiction_class=None,
            oscillation=Oscillation(detected=True, period=50.0, regularity=9.0),
            quantification=None,
        )

    return diagnose


def agent_of(
    bus,
    loops=("FIC101",),
    diagnose=None,
    seen=None,
    executor=None,
    scada=None,
    longest_wait=3.0,
    **loop_options,
):
    buses = [bus] if scada is None else [bus, scada]
    options = {"seconds": 400.0, "hop": 0.25, "publish": (Target(connection=buses[-1].name),)} | loop_options
    settings = Settings(
        agent=AgentSettings(longest_wait=longest_wait, clock_error=None),
        connections={each.name: ConnectionSettings("fake", Options()) for each in buses},
        loops=tuple(loop_settings(name, **options) for name in loops),
    )
    return Agent(
        settings,
        executor or InlineExecutor(),
        None if seen is None else seen.append,
        connectors=buses,
        diagnose=diagnose or judged(),
    )


async def worked(agent, seconds):
    """Let the agent work for some time and end it; nothing may be left of it."""
    task = asyncio.create_task(agent.run())
    await asyncio.sleep(seconds)
    status = agent.status()
    assert not task.done()
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    assert asyncio.all_tasks() == {asyncio.current_task()}
    return status


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
            yield sample("op", t, 50 + t / 1000)
            yield 1.0

    seen = []

    def diagnose(window, _seen=None):
        pytest.fail(f"a full diagnosis of {window.loop} at rest")

    status = virtual(worked(agent_of(FakeBus(source), diagnose=diagnose, seen=seen), 1000.0))
    assert {d.verdict for d in seen} == {"no_stiction"}
    assert {d.cause for d in seen} == {"no_oscillation"}
    assert status[0].alarm is State.NORMAL


def test_a_lost_connection_is_opened_anew_and_leaves_a_gap(caplog):
    def source(session):
        if session == 0:
            for t in range(300):
                yield from swinging("FIC101", t)
                yield 1.0
            raise ConnectionLostError("reset by peer")
        for t in range(320, 700):
            yield from swinging("FIC101", t)
            yield 1.0

    bus = FakeBus(source)
    with caplog.at_level(logging.INFO):
        status = virtual(worked(agent_of(bus), 650.0))
    assert len(bus.opened) == 2
    assert bus.opened[1] - 300.0 < 0.2
    assert status[0].gaps == 20
    said = [record.message for record in caplog.records if "connection" in record.message]
    assert said == ["connection bus is up", "connection bus is down: reset by peer", "connection bus is up"]


def test_a_peer_that_is_away_is_tried_with_growing_waits_and_logged_once(caplog):
    bus = FakeBus(stream(["FIC101"], 100))
    bus.refuses_connection = True
    agent = agent_of(bus)
    with caplog.at_level(logging.INFO):
        virtual(worked(agent, 600.0))
    waits = [b - a for a, b in zip(bus.attempts, bus.attempts[1:], strict=False)]
    assert max(waits) <= 3.0
    assert sum(waits[:4]) < 1.6
    assert 250 < len(bus.attempts) < 700  # 1.5 s on average
    assert agent.connections[0].health.losses == len(bus.attempts)
    assert [r.message for r in caplog.records] == ["connection bus is down: refused"]


class SlowBus(FakeBus):
    """Opens within 45 s, longer than a peer may take that does not answer."""

    opens_within = 50.0

    @asynccontextmanager
    async def _session(self):
        async with super()._session():
            await asyncio.sleep(45.0)
            yield self


def test_what_has_much_to_build_is_waited_for():
    bus = SlowBus(stream(["FIC101"], 200))
    (status,) = virtual(worked(agent_of(bus), 100.0))
    assert (len(bus.opened), status.samples) == (1, 2 * 56)
    bus.opens_within = 0.0
    (status,) = virtual(worked(agent_of(bus), 100.0))
    assert status.samples == 0


def test_a_peer_that_falls_silent_is_noticed():
    bus = FakeBus(stream(["FIC101"], 50))
    virtual(worked(agent_of(bus), 200.0))
    assert len(bus.opened) == 2  # 60 s after the last of 50 samples
    assert bus.opened[1] == pytest.approx(109.0, abs=0.2)


def test_a_peer_that_never_says_anything_is_noticed():
    bus = FakeBus(lambda _: iter(()))
    virtual(worked(agent_of(bus), 200.0))
    assert len(bus.opened) == 4


def test_a_fault_of_the_program_costs_one_attempt_and_is_counted(caplog):
    def source(session):
        yield from swinging("FIC101", session)
        yield 1.0
        raise ZeroDivisionError

    bus = FakeBus(source)
    agent = agent_of(bus)
    virtual(worked(agent, 60.0))
    assert len(bus.opened) > 10
    assert agent.connections[0].health.faults >= len(bus.opened) - 1
    assert "fault of this program" in caplog.text


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

    async def run(self, function, *args):
        await asyncio.sleep(250.0)
        return function(*args)


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


def test_what_could_not_be_published_is_published_when_the_peer_is_back():
    scada = FakeBus(None, name="scada")  # nothing is read from it
    scada.publish_fault = ConnectionLostError("broken pipe")
    agent = agent_of(FakeBus(stream(["FIC101"], 3600)), scada=scada)

    async def scenario():
        task = asyncio.create_task(agent.run())
        await asyncio.sleep(650.0)
        assert len(scada.opened) > 30
        assert not scada.published
        scada.publish_fault = None
        await asyncio.sleep(5.0)
        task.cancel()
        await asyncio.wait({task})

    virtual(scenario())
    assert [(p.kind, p.fields["active"]) for p in scada.published] == [("event", True), ("state", True)]
    assert [p.fields["time"] - START for p in scada.published] == [399.0, 599.0]


def test_a_peer_that_takes_nothing_is_not_hammered():
    """Reading works, so each session looks fine until the first publication."""
    bus = FakeBus(stream(["FIC101"], 400))
    bus.publish_fault = ConnectionLostError("broken pipe")
    virtual(worked(agent_of(bus), 1000.0))
    assert len(bus.opened) < 500


def test_what_a_peer_refuses_holds_up_no_others_and_is_taken_when_it_can(caplog):
    bus = FakeBus(stream(["FIC101"], 1000))
    bus.publish_fault = RefusedError("BadNotWritable")
    agent = agent_of(bus)

    async def scenario():
        task = asyncio.create_task(agent.run())
        await asyncio.sleep(910.0)
        refusals = agent.outboxes["bus"].refusals
        assert len(agent.outboxes["bus"]) == 0
        assert len(refusals) == 2  # the newest state, and the event of the alarm
        assert 7 < refusals.count < 40  # each new one, and every 30 s one that waits
        bus.publish_fault = None
        await asyncio.sleep(60.0)
        assert len(refusals) == 0
        task.cancel()
        await asyncio.wait({task})

    with caplog.at_level(logging.INFO):
        virtual(scenario())
    assert len(bus.opened) == 1
    assert sorted(p.kind for p in bus.published) == ["event", "state"]
    assert [p.fields["time"] - START for p in bus.published if p.kind == "state"] == [899.0]
    said = [r.message for r in caplog.records if " about FIC101" in r.message]
    assert (
        said
        == ["connection bus refused a publication about FIC101: BadNotWritable"] * 2
        + ["connection bus accepts publications about FIC101 again"] * 2
    )


def test_the_longest_wait_can_be_chosen():
    bus = FakeBus(stream(["FIC101"], 100))
    bus.refuses_connection = True
    virtual(worked(agent_of(bus, longest_wait=60.0), 3600.0))
    assert 60 < len(bus.attempts) < 200  # 30 s on average


def test_denied_access_is_logged_though_the_peer_was_gone_before(caplog):
    class CertificateError(AccessDeniedError):
        """A loss that some buses can distinguish."""

    faults = iter([ConnectionLostError("refused"), AccessDeniedError("wrong password; check it")])
    last = CertificateError("wrong certificate")
    bus = FakeBus(lambda _: iter([next(faults, last)]))
    virtual(worked(agent_of(bus), 600.0))
    assert len(bus.opened) > 100
    assert [r.message for r in caplog.records] == [
        "connection bus is down: refused",
        "connection bus is down: wrong password; check it",
    ]


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
