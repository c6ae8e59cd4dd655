"""What hangs is noticed, and systemd hears nothing more then; in virtual time."""

import asyncio
import contextlib
import functools
import itertools

from agent.runtime.operate.notify import ServiceManager
from agent.runtime.operate.watchdog import watch
from agent.runtime.supervisor import Health
from connectors.base import RefusedError
from tests.unit.runtime.agents import agent_of, stream, virtual
from tests.unit.runtime.fake_bus import FakeBus


class Manager(ServiceManager):
    """Writes down when it was told that the daemon lives."""

    def __init__(self, watchdog):
        super().__init__(None, watchdog)
        object.__setattr__(self, "heard", [])

    def alive(self):
        self.heard.append(asyncio.get_running_loop().time())


class StuckBus(FakeBus):
    """Neither opens nor lets itself be cancelled, until it is set free."""

    free = False

    def session(self):
        return self._stuck()

    @contextlib.asynccontextmanager
    async def _stuck(self):
        while not self.free:
            with contextlib.suppress(asyncio.CancelledError):
                await asyncio.sleep(10.0)
        yield self


async def watched(agent, seconds, free=lambda: None):
    manager = Manager(30.0)
    agent.accompany(Health("watchdog"), functools.partial(watch, agent.hung, manager))
    task = asyncio.create_task(agent.run())
    await asyncio.sleep(seconds)
    hung = agent.hung()
    free()
    task.cancel()
    await asyncio.wait({task})
    return manager.heard, hung


def test_signs_of_life_come_three_times_as_often_as_they_must():
    heard, hung = virtual(watched(agent_of(FakeBus(stream(["FIC101"], 1000)), quantify="always"), 595.0))
    assert len(heard) == 60
    assert max(b - a for a, b in itertools.pairwise(heard)) <= 10.5
    assert hung == ()


def test_peers_that_are_away_silent_or_refuse_are_no_reason_to_start_anew():
    away, silent, refusing = FakeBus(None), FakeBus(lambda _: iter(())), FakeBus(stream(["FIC101"], 1000))
    away.refuses_connection = True
    refusing.publish_fault = RefusedError("no")
    for bus in (away, silent, refusing):
        heard, hung = virtual(watched(agent_of(bus), 895.0))
        assert (len(heard), hung) == (90, ())


def test_an_attempt_that_never_comes_back_ends_the_signs_of_life_and_is_reported_once(caplog):
    bus = StuckBus(stream(["FIC101"], 1000))

    def free():
        bus.free = True

    heard, hung = virtual(watched(agent_of(bus), 595.0, free))
    assert 50.0 <= heard[-1] <= 70.0  # 30 s to open, and 30 s that a busy machine may take more
    assert hung == ("connection bus: open",)
    assert caplog.text.count("connection bus: open hangs") == 1
