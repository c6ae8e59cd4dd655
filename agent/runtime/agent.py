"""The daemon: connections and loops wired together, each a supervised task that can be replaced."""

from __future__ import annotations

import asyncio
import logging
import sys
import time
from collections.abc import Callable, Collection, Coroutine, Mapping, Sequence
from dataclasses import replace
from typing import Any

from agent.alarms import Announcement
from agent.analysis.diagnose import diagnose
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.routine import Diagnose
from agent.counted import counted
from agent.runtime.crew import Crew
from agent.runtime.keepers import keepers_of
from agent.runtime.link.connection import Connection
from agent.runtime.link.outbox import Outbox
from agent.runtime.link.withdrawal import leaving, withdraw
from agent.runtime.loop.judged import Judged, Observer
from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.loop.workers import Executor
from agent.runtime.operate.breath import breathing
from agent.runtime.operate.operators import Operators
from agent.runtime.operate.orders import Orders
from agent.runtime.operate.plan import AT_START, difference
from agent.runtime.operate.status import AgentStatus, LoopStatus, connection_status, loop_status
from agent.runtime.plant_wide import PlantWide
from agent.runtime.store.journal import Journal
from agent.runtime.supervisor import Health
from agent.runtime.wiring import Wiring
from agent.settings import Settings, connectors_of
from connectors.base import Connector

LOG = logging.getLogger(__name__)
LOOK = 0.5
"""Time between two looks for commands and at the end of shelving, s."""
Work = Callable[[], Coroutine[Any, Any, object]]


class Agent:
    """Reads loops, diagnoses them and publishes alarms until cancelled.

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
            executor: Runs diagnoses.
            on_diagnosis: Called with each diagnosis, in the event loop.
            connectors: One for each connection; None makes those of the settings.
            diagnose: Diagnoses a window.
            clock: Returns the time, s UTC.
        """
        self._settings = settings
        self._executor = executor
        self._clock = clock
        self._observers: list[Observer] = [_DiagnosisCallbacks(self._judged, on_diagnosis)]
        self._beside: list[tuple[Health, Work]] = []
        self._crew: Crew | None = None
        self._reloading = asyncio.Lock()
        self.journal = Journal(settings.agent.state, clock)
        kept = keepers_of(settings, clock)
        self.history, self.samples, self.forwarders = kept.history, kept.samples, kept.forwarders
        if kept.history is not None:
            self._observers.append(kept.history)
        self._beside += kept.tasks()
        self._wiring = Wiring(self.journal, executor, diagnose, self._observers, clock, self.samples)
        self._pipelines = self._wiring.pipelines
        operators = Operators(self._pipelines, self.journal, clock)
        self.accompany(operators.health, operators.run)
        self.plant_wide = PlantWide(self._pipelines, executor, clock)
        self.accompany(self.plant_wide.health, self.plant_wide.run)
        made = connectors_of(settings) if connectors is None else connectors
        self._wiring.wire(settings, {each.name: each for each in made}, settings.loops, at_work=False)

    @property
    def settings(self) -> Settings:
        """Settings in effect."""
        return self._settings

    @property
    def connections(self) -> list[Connection]:
        """In the order of the settings."""
        return list(self._wiring.connections.values())

    @property
    def pipelines(self) -> Mapping[str, LoopPipeline]:
        """What is done for each loop, by its name."""
        return self._pipelines

    @property
    def outboxes(self) -> Mapping[str, Outbox]:
        """Unpublished messages, by connection."""
        return self._wiring.outboxes

    @property
    def health(self) -> Mapping[str, Health]:
        """State of each loop's task."""
        return self._wiring.health

    @property
    def orders(self) -> Orders:
        """Orders that people send over the buses."""
        return self._wiring.orders

    def observe(self, observer: Observer) -> None:
        """Pass each verdict and each change of an alarm to ``observer``."""
        self._observers.append(observer)

    def accompany(self, health: Health, work: Work) -> None:
        """Keep another task alive from the start to the end of ``run``."""
        self._beside.append((health, work))

    async def run(self, ready: Callable[[], None] | None = None) -> None:
        """Continue from where the last run ended, until cancelled; then clean up within some seconds.

        ``ready`` is called as soon as all tasks are started.
        """
        try:
            await self._wiring.resume()
            async with Crew() as crew:
                self._crew = crew
                for health, work in self._beside:
                    crew.start(health, work)
                self._start(crew, self._wiring.connections, self._pipelines)
                if ready is not None:
                    ready()
        finally:
            self._crew = None
            for kept in (self.history, self.samples, *self.forwarders):
                if kept is not None:
                    await kept.close()
            await self.journal.close()

    async def reload(self, settings: Settings, connectors: Sequence[Connector] | None = None) -> None:
        """Apply other settings; windows, alarms and sessions that they leave unchanged continue.

        Raises:
            ConfigError: The settings cannot be applied; nothing has changed.
        """
        made = connectors_of(settings) if connectors is None else connectors
        async with self._reloading:
            crew, differs = self._crew, difference(self._settings, settings)
            if crew is None:
                return
            for name in differs.at_start:
                LOG.warning("agent.%s takes effect at the next start of the agent", name)
            wired = self._wiring
            await crew.end([self.health[name].name for name in self._pipelines if name in differs.loops])
            places = leaving(self._settings, settings)
            await withdraw(places, wired.connections, wired.outboxes, self._clock())
            ends = {name: each.health.name for name, each in wired.connections.items()}
            await crew.end([ends[name] for name in ends if name in differs.connections])
            same = {name: getattr(self._settings.agent, name) for name in AT_START}
            self._settings = replace(settings, agent=settings.agent.model_copy(update=same))
            try:
                self._wiring.wire(
                    self._settings,
                    {each.name: each for each in made if each.name in differs.connections},
                    [loop for loop in settings.loops if loop.name in differs.loops],
                    at_work=True,
                )
                self._start(crew, differs.connections, differs.loops)
            finally:
                error = sys.exception()
                if isinstance(error, Exception):
                    # Tasks that were ended would silently stay so: restart the whole agent instead.
                    crew.abort(error)
            await self.journal.flush()
        LOG.info(
            "%d of %d loops and %d of %d connections are new or changed",
            len(differs.loops & self._pipelines.keys()),
            len(self._pipelines),
            len(differs.connections & self._wiring.connections.keys()),
            len(self._wiring.connections),
            extra={"event": "reloaded"},
        )

    def newest(self, loop: str) -> float | None:
        """Return the newest source time received for a loop, s UTC; None before the first sample."""
        return self._pipelines[loop].window.newest

    def busy(self, loop: str) -> bool:
        """Whether a window of this loop is waiting for its diagnosis or being diagnosed."""
        return self._pipelines[loop].busy

    def status(self) -> tuple[LoopStatus, ...]:
        """Return the status of every loop; call it while the agent runs."""
        return tuple(
            loop_status(pipeline, self._settings, self.health[name])
            for name, pipeline in self._pipelines.items()
        )

    @property
    def summary(self) -> str:
        """Number of loops and connections, in a line."""
        loops = counted(len(self._pipelines), "loop")
        return f"watching {loops} on {counted(len(self._wiring.connections), 'connection')}"

    def hung(self) -> tuple[str, ...]:
        """Return the steps whose deadline has passed, e.g. ``connection unit1: open``."""
        now = asyncio.get_running_loop().time()
        members = {} if self._crew is None else self._crew.members
        busy = [(name, health) for name, health in members.items() if health.signs]  # few of 10,000 loops
        overdue = ((name, health.overdue(now)) for name, health in busy)
        return tuple(f"{name}: {sign}" for name, sign in overdue if sign is not None)

    async def looked(self) -> AgentStatus:
        """Return the status of the whole agent, a few loops at a time: samples are read meanwhile."""
        loops = [
            loop_status(pipeline, self._settings, self.health[name])
            async for name, pipeline in breathing(list(self._pipelines.items()))
            if self._pipelines.get(name) is pipeline  # the configuration may change meanwhile
        ]
        connections = self._wiring.connections
        return AgentStatus(
            loops=tuple(loops),
            connections=tuple(
                connection_status(connections[name], self.outboxes[name], each.kind, self._clock())
                for name, each in self._settings.connections.items()
            ),
            hung=self.hung(),
            faults=sum(health.faults for health, _ in self._beside),
            store_problem=self.journal.problem,
            store_failures=self.journal.failures,
            history_dropped=(0 if self.history is None else self.history.dropped)
            + sum(each.dropped for each in self.forwarders),
            orders_taken=self.orders.taken,
            orders_refused=self.orders.refused,
            queued=self._executor.queued,
        )

    def _start(self, crew: Crew, connections: Collection[str], loops: Collection[str]) -> None:
        """Start those of the named connections and loops that exist."""
        for name, connection in self._wiring.connections.items():
            if name in connections:
                crew.start(connection.health, connection.attempt, self._settings.agent.longest_wait)
        for name, pipeline in self._pipelines.items():
            if name in loops:
                crew.start(self.health[name], pipeline.run)

    def _judged(self, diagnosis: Diagnosis) -> None:
        """Note that a loop with a previous fault works again."""
        health = self.health.get(diagnosis.loop)
        if health is not None and health.problem:
            health.works()


class _DiagnosisCallbacks:
    """Observer that passes each diagnosis to functions."""

    def __init__(self, *callbacks: Callable[[Diagnosis], None] | None) -> None:
        self._callbacks = [each for each in callbacks if each is not None]

    def judged(self, judged: Judged) -> None:
        for callback in self._callbacks:
            callback(judged.diagnosis)

    def announced(self, _: Announcement) -> None:
        pass
