"""A broker that ends the connection at a topic that may not be published: the other loops go on."""

import asyncio

from connectors.base import ConnectionLostError
from tests.unit.runtime.agents import agent_of, stream, swinging, virtual, worked
from tests.unit.runtime.fake_bus import FakeBus

LOOPS = ("FIC101", "FIC102")


class HangsUp(FakeBus):
    """Ends the session at a publication about one loop."""

    forbidden = "FIC101"

    async def publish(self, publication):
        if publication.subject == self.forbidden:
            raise ConnectionLostError("connection closed by the broker")
        await super().publish(publication)


def on_and_on(_session):
    """Two loops that oscillate, at the time of the event loop."""
    while True:
        for loop in LOOPS:
            yield from swinging(loop, round(asyncio.get_running_loop().time()))
        yield 1.0


class EndsReading(HangsUp):
    """The same, where the end shows to who reads, as with aiomqtt; the publication just gets no answer."""

    hung_up = False

    async def samples(self):
        self.hung_up = False
        async for each in super().samples():
            if self.hung_up:
                raise ConnectionLostError("disconnected during message iteration")
            yield each

    async def publish(self, publication):
        if publication.subject == self.forbidden:
            self.hung_up = True
            await asyncio.Event().wait()
        await FakeBus.publish(self, publication)


def test_the_same_where_the_reader_notices_it_first():
    bus = EndsReading(on_and_on)
    agent = agent_of(bus, LOOPS, hop=1.0)
    virtual(worked(agent, 3600.0))
    refusals = agent.outboxes["bus"].refusals
    assert {each.subject for each in bus.published} == {"FIC102"}
    assert "ends the connection at this publication" in refusals.reasons[0]
    assert len(bus.opened) < 60


def test_a_topic_at_which_the_broker_hangs_up_is_parked_and_the_rest_is_published():
    scada = HangsUp(None, name="scada")
    agent = agent_of(FakeBus(stream(LOOPS, 7200)), LOOPS, scada=scada, hop=1.0)

    async def scenario():
        task = asyncio.create_task(agent.run())
        await asyncio.sleep(3600.0)
        refusals = agent.outboxes["scada"].refusals
        seen = len(scada.opened), refusals.reasons, refusals.count
        scada.forbidden = ""
        await asyncio.sleep(3600.0)
        left = len(refusals)
        task.cancel()
        await asyncio.wait({task})
        return seen, left

    (opened, reasons, count), left = virtual(scenario())
    about = {each.subject for each in scada.published}
    assert about == set(LOOPS)
    assert any(each.subject == "FIC102" and each.kind == "event" for each in scada.published)
    assert "ends the connection at this publication" in reasons[0]
    assert count >= 1
    assert opened < 60  # later and later attempts; with each new state three more
    assert left == 0
    events = [each.id for each in scada.published if each.kind == "event"]
    assert len(events) == len(set(events)) == 2  # nothing lost, nothing doubled
