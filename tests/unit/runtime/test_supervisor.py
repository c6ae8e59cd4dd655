"""How long a peer that is away must wait for us once it is back."""

import asyncio
import itertools

import pytest

from agent.runtime.supervisor import Health, keep_alive
from connectors.base import ConnectionLostError
from tests.unit.runtime.agents import virtual


def attempts(work, seconds):
    """When ``work(health)`` was tried in so many seconds, with the longest waits that may come."""
    health, began = Health("peer"), []

    async def attempt():
        began.append(asyncio.get_running_loop().time())
        await work(health)

    async def scenario():
        task = asyncio.create_task(keep_alive(attempt, health, uniform=lambda _, longest: longest))
        await asyncio.sleep(seconds)
        task.cancel()
        await asyncio.wait({task})

    virtual(scenario())
    return [b - a for a, b in itertools.pairwise(began)]


async def never_answers(_):
    await asyncio.sleep(4.0)
    raise ConnectionLostError("no answer")


async def refuses(_):
    raise ConnectionLostError("refused")


async def works_for_a_while(health):
    health.works()
    await asyncio.sleep(4.0)
    raise ConnectionLostError("reset")


def test_time_in_which_a_peer_never_answered_is_not_waited_twice():
    assert attempts(never_answers, 100.0) == pytest.approx([4.0] * 24)


def test_a_peer_that_refuses_is_requested_ever_less_often():
    assert attempts(refuses, 20.0)[:7] == pytest.approx([0.1, 0.2, 0.4, 0.8, 1.6, 3.0, 3.0])


def test_a_peer_that_worked_is_given_its_pause():
    assert attempts(works_for_a_while, 60.0)[:6] == pytest.approx([4.1, 4.2, 4.4, 4.8, 5.6, 7.0])
