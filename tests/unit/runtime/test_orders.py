"""What people ask over a bus: obeyed, or counted and told; never an end of the connection."""

import asyncio
import logging
from typing import get_args

import pytest

from agent.alarms import State
from agent.alarms.command import EVENTS
from connectors.base import Action, ConnectionLostError, Order
from tests.unit.runtime.agents import agent_of, stream, virtual, worked
from tests.unit.runtime.fake_bus import FakeBus

RAISED = 39.0 + 1.7e9
"""End of the first window, s UTC, which raises the alarm."""


def ask(action, until=None, alarm=None, loop="FIC101", by="jane"):
    return Order(loop, action, by, until, alarm)


def ordered(*orders, longer=60.0):
    """The agent and its bus after an alarm came, and people then asked for these over another bus."""
    data = stream(["FIC101"], 45)

    async def scenario():
        plant = FakeBus(lambda session: data(0) if session == 0 else ())
        scada = FakeBus(lambda _: [50.0, *orders], name="scada", takes_orders=True)
        agent = agent_of(plant, scada=scada, seconds=40.0, quantify="always")
        agent.orders._clock = lambda: 1.8e9
        status = await worked(agent, longer)
        return agent, scada, status[0].alarm

    return virtual(scenario())


@pytest.mark.parametrize(
    ("orders", "state"),
    [
        ([ask("acknowledge")], State.ACKED_ACTIVE),
        ([ask("acknowledge", alarm=f"FIC101/{RAISED:.6f}")], State.ACKED_ACTIVE),
        ([ask("shelve", until=1.9e9)], State.SHELVED),
        ([ask("shelve", until=1.9e9), ask("unshelve")], State.UNACKED_ACTIVE),
        ([ask("out_of_service")], State.OUT_OF_SERVICE),
        ([ask("out_of_service"), ask("in_service")], State.UNACKED_ACTIVE),
    ],
)
def test_an_order_is_obeyed_and_reported_on_the_bus(orders, state):
    agent, scada, now = ordered(*orders)
    assert now is state
    assert (agent.orders.taken, agent.orders.refused) == (len(orders), 0)
    events = [p.fields["state"] for p in scada.published if p.kind == "event"]
    assert (events[0], events[-1]) == ("unacked_active", state)
    last = [p for p in scada.published if p.kind == "state"][-1]
    assert (last.fields["state"], last.fields["by"]) == (state, "jane")


@pytest.mark.parametrize(
    ("order", "why"),
    [
        (ask("acknowledge", loop="FIC999"), "no such loop"),
        (ask("acknowledge", alarm="FIC101/1.000000"), "meant for 'FIC101/1.000000'"),
        (ask("shelve"), "expected an end time for shelve"),
        (ask("shelve", until=1.0), "the end of shelving must be after its start"),
        (ask("shelve", until=float("nan")), "the end of shelving must be after its start"),
        (ask("acknowledge", until=1.9e9), "expected an end time for shelve"),
        (ask("acknowledge", by=""), "expected the name of the person who decided"),
        (ask("explode"), "expected one of acknowledge"),
        (ask("unshelve"), "means nothing while it is unacked_active"),
    ],
)
def test_an_order_without_sense_is_counted_and_reported_once(order, why, caplog):
    with caplog.at_level(logging.WARNING):
        agent, scada, state = ordered(order, order)
    assert state is State.UNACKED_ACTIVE
    assert (agent.orders.taken, agent.orders.refused) == (0, 2)
    assert len(scada.opened) == 1
    (told,) = [record.message for record in caplog.records if "order" in record.name]
    assert why in told
    assert "over scada" in told


def test_people_may_be_silent_and_the_bus_is_still_read():
    agent, scada, state = ordered(3600.0, ask("acknowledge"), longer=3700.0)
    assert state is State.ACKED_ACTIVE
    assert len(scada.opened) == 1
    assert agent.connections[1].health.up


def test_orders_are_no_sign_of_life_of_the_data():
    orders = [step for _ in range(100) for step in (ask("acknowledge"), 10.0)]
    bus = FakeBus(lambda _: orders, takes_orders=True)
    virtual(worked(agent_of(bus), 200.0))
    assert len(bus.opened) == 4  # 60 s each


def test_a_bus_that_only_takes_orders_and_is_lost_is_opened_anew():
    bus = FakeBus(lambda _: [10.0, ConnectionLostError("gone")], name="scada", takes_orders=True)
    virtual(worked(agent_of(FakeBus(stream(["FIC101"], 100)), scada=bus), 100.0))
    assert len(bus.opened) > 8


def test_an_order_is_on_disk_when_it_is_obeyed():
    async def scenario():
        agent = agent_of(FakeBus(stream(["FIC101"], 10)))
        flushed = []

        async def flush():
            flushed.append(agent.status()[0].alarm)

        agent.journal.flush = flush
        await agent.orders.obey("scada", ask("out_of_service"))
        return flushed

    assert asyncio.run(scenario()) == [State.OUT_OF_SERVICE]


def test_the_words_of_a_bus_are_those_of_the_commands():
    assert set(EVENTS) == set(get_args(Action))
