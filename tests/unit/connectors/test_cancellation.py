"""A task that is told to end while a library holds that back ends all the same."""

import asyncio
import contextlib
from types import SimpleNamespace

import pytest

from connectors.cancellation import ends_when_cancelled, obey_cancellation
from connectors.modbus.client import ModbusClient
from connectors.modbus.options import ModbusOptions
from simulators.clock import Clock
from simulators.plant import Row
from simulators.player import play


async def deaf(*_args, **_more):
    """Answer even when cancelled, as ``asyncio.wait_for`` of Python 3.11 when the answer is there."""
    with contextlib.suppress(asyncio.CancelledError):
        await asyncio.sleep(0.01)
    return SimpleNamespace(isError=lambda: False, registers=[7], bits=[True])


async def require_cancelled(work):
    task = asyncio.create_task(work)
    await asyncio.sleep(0.005)  # it waits within the library now
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await asyncio.wait_for(task, 2)


async def test_a_task_that_was_not_cancelled_goes_on():
    obey_cancellation()


async def test_a_poll_of_modbus_that_never_has_news():
    pymodbus = SimpleNamespace(ctx=SimpleNamespace(callback_data=None, callback_disconnected=None))
    client = ModbusClient(pymodbus, ModbusOptions(), None)

    async def ask(*_):
        await deaf()
        return b"\x04\x02\x00\x07"

    client._numbered.ask = ask

    async def poll():
        while True:
            await client.read("input", 0, 1)

    await require_cancelled(poll())


async def test_a_player_of_an_endless_plant():
    class Plant:
        loop, ts = "FIC101", 1.0

        def rows(self):
            k = 0.0
            while True:
                yield Row(k, {})
                k += 1.0

    await require_cancelled(play([Plant()], SimpleNamespace(lead=0, put=deaf), Clock(1e6)))


async def test_work_that_waits_again_after_it_swallowed_a_cancellation():
    async def stubborn():
        await deaf()
        await asyncio.Event().wait()

    await require_cancelled(ends_when_cancelled(stubborn()))


async def test_work_that_fails_once_it_is_cancelled_leaves_the_cancellation():
    async def failing():
        await deaf()
        raise OSError("the peer is gone")

    await require_cancelled(ends_when_cancelled(failing()))
