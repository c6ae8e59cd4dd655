"""What the daemon publishes: kept while a peer is away, and parked where one refuses it."""

import asyncio
import logging

from connectors.base import AccessDeniedError, ConnectionLostError, RefusedError
from tests.unit.runtime.agents import agent_of, stream, virtual, worked
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import START


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
