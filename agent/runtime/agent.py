"""The daemon: connections and loops wired together, each a task that cannot die and can be replaced."""

from __future__ import annotations

import asyncio
import functools
import logging
import sys
import time
from collections.abc import Callable, Collection, Coroutine, Mapping, Sequence
from dataclasses import replace
from typing import Any, NoReturn

from agent.alarms import Alarm, Announcement
from agent.analysis.diagnose import diagnose
from agent.analysis.results import Diagnosis
from agent.runtime.change import Change
from agent.runtime.connection import Connection
from agent.runtime.crew import Crew
from agent.runtime.history import History
from agent.runtime.history_file import history_path
from agent.runtime.journal import Journal
from agent.runtime.orders import Orders
from agent.runtime.outbox import Outbox
from agent.runtime.pipeline import Diagnose, Judged, LoopPipeline, Observer
from agent.runtime.plan import AT_START, connection_plans, difference
from agent.runtime.source_clock import SourceClock
from agent.runtime.status import AgentStatus, LoopStatus, connection_status, loop_status
from agent.runtime.supervisor import MARGIN, Health
from agent.runtime.workers import Executor
from agent.settings import LoopSettings, Settings, connectors_of
from connectors.base import Connector, Publication, Sample
from connectors.cancellation import obey_cancellation

LOG = logging.getLogger(__name__)
LOOK = 0.5
"""Time between two looks for commands and at the end of shelving, s."""
Work = Callable[[], Coroutine[Any, Any, object]]


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
        self._executor = executor
        self._diagnose = diagnose
        self._clock = clock
        self._observers: list[Observer] = [_Teller(self._judged, on_diagnosis)]
        self._kept: dict[str, Alarm] = {}
        self._beside: list[tuple[Health, Work]] = []
        self._crew: Crew | None = None
        self._reloading = asyncio.Lock()
        self._pipelines: dict[str, LoopPipeline] = {}
        self._connections: dict[str, Connection] = {}
        self.journal = Journal(settings.agent.state, clock)
        self.outboxes: dict[str, Outbox] = {}
        self.health: dict[str, Health] = {}
        """How each loop fares."""
        self.orders = Orders(self._pipelines, self.journal, clock)
        self.operators = Health("commands of operators")
        self.history: History | None = None
        if settings.agent.state is not None and settings.agent.history is not None:
            self.history = History(history_path(settings.agent.state), settings.agent.history, clock)
            self._observers.append(self.history)
            self.accompany(Health("history"), self.history.run)
        self.accompany(self.operators, self._serve_operators)
        made = connectors_of(settings) if connectors is None else connectors
        self._wire({connector.name: connector for connector in made}, settings.loops)

    @property
    def settings(self) -> Settings:
        """What it works by now."""
        return self._settings

    @property
    def connections(self) -> list[Connection]:
        """In the order of the settings."""
        return list(self._connections.values())

    def observe(self, observer: Observer) -> None:
        """Have ``observer`` told what becomes of every loop."""
        self._observers.append(observer)

    def accompany(self, health: Health, work: Work) -> None:
        """Keep other work alive beside, from the start to the end of ``run``."""
        self._beside.append((health, work))

    async def run(self, ready: Callable[[], None] | None = None) -> None:
        """Go on where the last run ended, work until cancelled, then clean up within some seconds.

        ``ready`` is called as soon as all of it is at work.
        """
        await self._resume()
        try:
            async with Crew() as crew:
                self._crew = crew
                for health, work in self._beside:
                    crew.start(health, work)
                self._start(crew, self._connections, self._pipelines)
                if ready is not None:
                    ready()
        finally:
            self._crew = None
            if self.history is not None:
                await self.history.close()
            await self.journal.close()

    async def reload(self, settings: Settings, connectors: Sequence[Connector] | None = None) -> None:
        """Go over to other settings; what they leave as it is goes on: windows, alarms and sessions.

        Raises:
            ConfigError: They cannot be; nothing has changed.
        """
        made = connectors_of(settings) if connectors is None else connectors
        async with self._reloading:
            crew, differs = self._crew, difference(self._settings, settings)
            if crew is None:
                return
            for name in differs.at_start:
                LOG.warning("agent.%s takes effect when the agent is started anew", name)
            ends = [self.health[name].name for name in self._pipelines if name in differs.loops]
            ends += [c.health.name for name, c in self._connections.items() if name in differs.connections]
            await crew.end(ends)
            same = {name: getattr(self._settings.agent, name) for name in AT_START}
            self._settings = replace(settings, agent=settings.agent.model_copy(update=same))
            try:
                self._wire(
                    {each.name: each for each in made if each.name in differs.connections},
                    [loop for loop in settings.loops if loop.name in differs.loops],
                )
                self._start(crew, differs.connections, differs.loops)
            finally:
                error = sys.exception()
                if isinstance(error, Exception):
                    crew.abort(
                        error
                    )  # what was ended would stay so, in silence: rather start anew as a whole
            await self.journal.flush()
        LOG.info(
            "%d of %d loops and %d of %d connections are new or changed",
            len(differs.loops & self._pipelines.keys()),
            len(self._pipelines),
            len(differs.connections & self._connections.keys()),
            len(self._connections),
            extra={"event": "reloaded"},
        )

    def newest(self, loop: str) -> float | None:
        """Newest source time that came in for a loop, s UTC; None before the first sample."""
        return self._pipelines[loop].window.newest

    def busy(self, loop: str) -> bool:
        """Whether a window of this loop waits for its diagnosis or has it made."""
        return self._pipelines[loop].busy

    def status(self) -> tuple[LoopStatus, ...]:
        """Look at every loop; call it while the agent runs."""
        return tuple(
            loop_status(pipeline, self._settings, self.health[name])
            for name, pipeline in self._pipelines.items()
        )

    @property
    def summary(self) -> str:
        """What it watches, in a line."""
        return f"watching {len(self._pipelines)} loops on {len(self._connections)} connections"

    def hung(self) -> tuple[str, ...]:
        """Return what should have come back by now and has not, e.g. ``connection unit1: open``."""
        now = asyncio.get_running_loop().time()
        members = {} if self._crew is None else self._crew.members
        overdue = {name: health.overdue(now) for name, health in members.items()}
        return tuple(f"{name}: {sign}" for name, sign in overdue.items() if sign is not None)

    def overview(self) -> AgentStatus:
        """Look at all there is; call it while the agent runs."""
        return AgentStatus(
            loops=self.status(),
            connections=tuple(
                connection_status(self._connections[name], self.outboxes[name], each.kind, self._clock())
                for name, each in self._settings.connections.items()
            ),
            hung=self.hung(),
            faults=sum(health.faults for health, _ in self._beside),
            store_failures=self.journal.failures,
            history_dropped=0 if self.history is None else self.history.dropped,
            orders_taken=self.orders.taken,
            orders_refused=self.orders.refused,
            queued=self._executor.queued,
        )

    def _wire(self, connectors: Mapping[str, Connector], loops: Collection[LoopSettings]) -> None:
        """Make these connections and loops anew, keep the others that are in the settings, drop all else."""
        settings = self._settings
        for name in self.outboxes.keys() - settings.connections.keys():
            self._never_told(name, self.outboxes.pop(name).emptied())
        for name in settings.connections:
            self.outboxes.setdefault(name, Outbox(name, self.journal))
        changed = {loop.name: self._pipeline(loop) for loop in loops}
        former = dict(self._pipelines)
        for name, pipeline in changed.items():
            if name in former:
                pipeline.take_over(former[name])
            elif self._crew is not None:
                pipeline.resume(self._kept.get(name))
        self._kept |= {name: pipeline.alarm for name, pipeline in former.items()}
        self._pipelines.clear()  # the same object still: others look loops up in it
        self._pipelines |= {loop.name: changed.get(loop.name) or former[loop.name] for loop in settings.loops}
        self.health = {
            name: Health(f"loop {name}", about={"loop": name}) if name in changed else self.health[name]
            for name in self._pipelines
        }
        if self._crew is not None:
            for pipeline in self._pipelines.values():
                if any(target.connection in connectors for target in pipeline.settings.publish):
                    pipeline.tell_again(self._clock())
        plans = connection_plans(settings)
        self._connections = {
            name: self._connection(connectors[name], plan.data_age)
            if name in connectors
            else self._connections[name]
            for name, plan in plans.items()
        }

    def _start(self, crew: Crew, connections: Collection[str], loops: Collection[str]) -> None:
        """Start those of these that there are."""
        for name, connection in self._connections.items():
            if name in connections:
                crew.start(connection.health, connection.attempt, self._settings.agent.longest_wait)
        for name, pipeline in self._pipelines.items():
            if name in loops:
                crew.start(self.health[name], pipeline.run)

    async def _resume(self) -> None:
        """Take alarms, and what waits to be told, from the store."""
        kept = await self.journal.open()
        self._kept = dict(kept.alarms)
        for name, pipeline in self._pipelines.items():
            pipeline.resume(self._kept.get(name))
        for name in {each.target for each in kept.waiting.values()}:
            waiting = {n: each.publication for n, each in kept.waiting.items() if each.target == name}
            if name in self.outboxes:
                self.outboxes[name].restore(waiting)
            else:
                self._never_told(name, waiting)
        for name in self._kept.keys() & self._pipelines.keys():
            self._pipelines[name].tell_again(self._clock())
        await self.journal.flush()

    def _judged(self, diagnosis: Diagnosis) -> None:
        """Note that a loop works again on which the program had failed."""
        health = self.health.get(diagnosis.loop)
        if health is not None and health.problem:
            health.works()

    def _never_told(self, connection: str, waiting: Mapping[int, Publication]) -> None:
        """Give up what waits for a connection that is gone from the settings."""
        for publication in waiting.values():
            LOG.warning("no connection is called %s any more: %s is never told", connection, publication.id)
        self.journal.note(Change(removed=frozenset(waiting)))

    async def _serve_operators(self) -> NoReturn:
        """Obey what people left in the store, and end shelving in time."""
        while True:
            self.operators.expect("look", MARGIN)
            for told in await self.journal.commands():
                pipeline = self._pipelines.get(told.loop)
                if pipeline is None or told.command is None:
                    LOG.warning("command %d for %s cannot be obeyed", told.number, told.loop)
                else:
                    LOG.info(
                        "%s: %s by %s",
                        told.loop,
                        told.command.event,
                        told.command.by,
                        extra={"event": "order", "loop": told.loop},
                    )
                    pipeline.obey(told.command)
                self.journal.note(Change(taken=frozenset({told.number})))
            now = self._clock()
            for pipeline in self._pipelines.values():
                pipeline.look_at_clock(now)
            await self.journal.flush()
            obey_cancellation()
            await asyncio.sleep(LOOK)

    def _pipeline(self, loop: LoopSettings) -> LoopPipeline:
        limit = self._settings.agent.clock_error
        return LoopPipeline(
            loop,
            self._executor,
            [self.outboxes[name] for name in dict.fromkeys(target.connection for target in loop.publish)],
            self._observers,
            self._diagnose,
            self.journal,
            None if limit is None else SourceClock(loop.name, limit, self._clock),
        )

    def _connection(self, connector: Connector, data_age: float) -> Connection:
        name, outbox = connector.name, self.outboxes[connector.name]

        def read() -> list[LoopPipeline]:
            return [each for each in self._pipelines.values() if each.settings.connection == name]

        def deliver(sample: Sample) -> None:
            pipeline = self._pipelines.get(sample.tag.rpartition(".")[0])
            if pipeline is not None:
                pipeline.push(sample, asyncio.get_running_loop().time())

        def interrupted() -> None:
            outbox.interrupt()
            for pipeline in read():
                pipeline.window.interrupt()

        obey = functools.partial(self.orders.obey, name) if connector.takes_orders else None
        return Connection(connector, outbox, deliver if read() else None, interrupted, data_age, obey)


class _Teller:
    """Tells diagnoses to functions."""

    def __init__(self, *tell: Callable[[Diagnosis], None] | None) -> None:
        self._tell = [each for each in tell if each is not None]

    def judged(self, judged: Judged) -> None:
        for tell in self._tell:
            tell(judged.diagnosis)

    def announced(self, _: Announcement) -> None:
        pass
