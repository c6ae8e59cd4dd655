"""Connections of the daemon: lost, silent, away, and opened again."""

import asyncio
import logging
from contextlib import asynccontextmanager

import pytest

from connectors.base import ConnectionLostError
from tests.unit.runtime.agents import agent_of, stream, swinging, virtual, worked
from tests.unit.runtime.fake_bus import FakeBus


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
    (status,) = virtual(worked(agent_of(bus), 100.5))  # no sample comes at the very end
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
