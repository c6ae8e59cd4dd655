"""The daemon: connections and loops wired together, each a task that cannot die."""

from __future__ import annotations

import asyncio
import functools
import logging
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NoReturn

from agent.alarms import State
from agent.analysis.diagnose import diagnose
from agent.analysis.results import Diagnosis, Oscillation
from agent.runtime.change import Change
from agent.runtime.connection import Connection
from agent.runtime.journal import Journal
from agent.runtime.orders import Orders
from agent.runtime.outbox import Outbox
from agent.runtime.pipeline import Diagnose, LoopPipeline
from agent.runtime.source_clock import SourceClock
from agent.runtime.supervisor import Health, keep_alive
from agent.runtime.workers import Executor
from agent.settings import Settings, connectors_of
from connectors.base import Connector, Sample
from connectors.cancellation import obey_cancellation

LOG = logging.getLogger(__name__)
LOOK = 0.5
"""Time between two looks for commands and at the end of shelving, s."""


@dataclass(frozen=True, slots=True)
class LoopStatus:
    """What is known of a loop at this moment."""

    loop: str
    bus: str
    """Kind of the connection that it is read from."""
    samples: int
    gaps: int
    """Grid points without PV or OP in the newest window."""
    data_age: float | None
    """Time since the newest sample arrived, s; None before the first."""
    oscillation: Oscillation | None
    diagnosis: Diagnosis | None
    alarm: State


class Agent:
    """Reads loops, diagnoses them and publishes alarms, until cancelled.

    For example::

        async with PoolExecutor(settings.agent.workers) as executor:
            await Agent(settings, executor).run()
    """

    def __init__(
        self,
        settings: Settings,
        executor: Executor,
        on_diagnosis: Callable[[Diagnosis], None] | None = None,
        *,
        connectors: Sequence[Connector] | None = None,
        diagnose: Diagnose = diagnose,
        clock: Callable[[], float] = time.time,
    ) -> None:
        """Wire it up; nothing is opened yet.

        Args:
            settings: What to read and where to publish.
            executor: Where diagnoses run.
            on_diagnosis: Called with each diagnosis, in the event loop.
            connectors: One for each connection; None makes those of the settings.
            diagnose: What judges a window.
            clock: Gives the time, s UTC.
        """
        self._settings = settings
        connectors = connectors_of(settings) if connectors is None else connectors
        self._clock = clock
        self.journal = Journal(settings.agent.state, clock)
        self.outboxes = {connector.name: Outbox(connector.name, self.journal) for connector in connectors}
        limit = settings.agent.clock_error
        self._pipelines = {
            loop.name: LoopPipeline(
                loop,
                executor,
                [self.outboxes[name] for name in dict.fromkeys(t.connection for t in loop.publish)],
                on_diagnosis,
                diagnose,
                self.journal,
                None if limit is None else SourceClock(loop.name, limit, clock),
            )
            for loop in settings.loops
        }
        self.orders = Orders(self._pipelines, self.journal, clock)
        self.connections = [self._connection(connector) for connector in connectors]
        self.health = {name: Health(f"loop {name}") for name in self._pipelines}
        self.operators = Health("commands of operators")

    async def run(self) -> None:
        """Go on where the last run ended, work until cancelled, then clean up within some seconds."""
        await self._resume()
        try:
            await self._work()
        finally:
            await self.journal.close()

    async def _work(self) -> None:
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(keep_alive(self._serve_operators, self.operators), name=self.operators.name)
            for connection in self.connections:
                work = keep_alive(connection.attempt, connection.health, self._settings.agent.longest_wait)
                tasks.create_task(work, name=connection.health.name)
            for name, pipeline in self._pipelines.items():
                tasks.create_task(keep_alive(pipeline.run, self.health[name]), name=self.health[name].name)

    def newest(self, loop: str) -> float | None:
        """Newest source time that came in for a loop, s UTC; None before the first sample."""
        return self._pipelines[loop].window.newest

    def busy(self, loop: str) -> bool:
        """Whether a window of this loop waits for its diagnosis or has it made."""
        return self._pipelines[loop].busy

    def status(self) -> tuple[LoopStatus, ...]:
        """Look at every loop; call it while the agent runs."""
        now = asyncio.get_running_loop().time()
        return tuple(self._status(pipeline, now) for pipeline in self._pipelines.values())

    async def _resume(self) -> None:
        """Take alarms, and what waits to be told, from the store."""
        kept = await self.journal.open()
        for name, pipeline in self._pipelines.items():
            pipeline.resume(kept.alarms.get(name))
        for name, outbox in self.outboxes.items():
            outbox.restore({n: each.publication for n, each in kept.waiting.items() if each.target == name})
        homeless = {n: each for n, each in kept.waiting.items() if each.target not in self.outboxes}
        for each in homeless.values():
            LOG.warning(
                "no connection is called %s any more: %s is never told", each.target, each.publication.id
            )
        self.journal.note(Change(removed=frozenset(homeless)))
        await self.journal.flush()

    async def _serve_operators(self) -> NoReturn:
        """Obey what people left in the store, and end shelving in time."""
        while True:
            for told in await self.journal.commands():
                pipeline = self._pipelines.get(told.loop)
                if pipeline is None or told.command is None:
                    LOG.warning("command %d for %s cannot be obeyed", told.number, told.loop)
                else:
                    LOG.info("%s: %s by %s", told.loop, told.command.event, told.command.by)
                    pipeline.obey(told.command)
                self.journal.note(Change(taken=frozenset({told.number})))
            for pipeline in self._pipelines.values():
                pipeline.look_at_clock(self._clock())
            await self.journal.flush()
            obey_cancellation()
            await asyncio.sleep(LOOK)

    def _status(self, pipeline: LoopPipeline, now: float) -> LoopStatus:
        window, settings, diagnosis = pipeline.window, pipeline.settings, pipeline.diagnosis
        return LoopStatus(
            loop=settings.name,
            bus=self._settings.connections[settings.connection].kind,
            samples=window.counters.samples,
            gaps=window.counters.missing,
            data_age=None if window.arrival is None else now - window.arrival,
            oscillation=None if diagnosis is None else diagnosis.oscillation,
            diagnosis=diagnosis,
            alarm=pipeline.alarm.state,
        )

    def _connection(self, connector: Connector) -> Connection:
        read = [p for p in self._pipelines.values() if p.settings.connection == connector.name]

        def deliver(sample: Sample) -> None:
            pipeline = self._pipelines.get(sample.tag.rpartition(".")[0])
            if pipeline is not None:
                pipeline.push(sample, asyncio.get_running_loop().time())

        outbox = self.outboxes[connector.name]

        def interrupted() -> None:
            outbox.interrupt()
            for pipeline in read:
                pipeline.window.interrupt()

        slowest = max((p.settings.ts for p in read), default=0.0)
        data_age = max(self._settings.agent.data_age, 5 * slowest)
        obey = functools.partial(self.orders.obey, connector.name) if connector.takes_orders else None
        return Connection(connector, outbox, deliver if read else None, interrupted, data_age, obey)
