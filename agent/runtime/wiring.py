"""Builds connections and loops from the settings, and connects them to each other."""

from __future__ import annotations

import asyncio
import functools
import logging
import math
from collections.abc import Callable, Collection, Mapping, Sequence

from agent.alarms import Alarm
from agent.analysis.memory.valve_memory import ValveMemory
from agent.analysis.routine import Diagnose
from agent.runtime.intake.gathering import Gatherings
from agent.runtime.intake.intake import Intake
from agent.runtime.intake.source_clock import SourceClock
from agent.runtime.link.connection import Connection
from agent.runtime.link.outbox import Outbox
from agent.runtime.loop.judged import Observer
from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.loop.workers import Executor
from agent.runtime.operate.orders import Orders
from agent.runtime.operate.plan import connection_plans
from agent.runtime.samples.recorder import SampleRecorder
from agent.runtime.store.change import Change
from agent.runtime.store.journal import Journal
from agent.runtime.supervisor import Health
from agent.settings import AgentSettings, LoopSettings, Settings
from connectors.base import Connector, Publication, Sample
from connectors.readings import Readings

LOG = logging.getLogger(__name__)
TOGETHER = 200
"""Loops whose first windows come due together, some tenths of a second of the event loop. In a larger plant
others follow over a hop, or all that began together would come due together for ever."""


class Wiring:
    """The parts of an agent; some can be rebuilt while the agent runs."""

    def __init__(
        self,
        journal: Journal,
        executor: Executor,
        diagnose: Diagnose,
        observers: Sequence[Observer],
        clock: Callable[[], float],
        recorder: SampleRecorder | None = None,
    ) -> None:
        """Make an empty one.

        Args:
            journal: Keeps alarms and unpublished messages.
            executor: Runs diagnoses.
            diagnose: Diagnoses a window.
            observers: Receive each verdict and each change of an alarm.
            clock: Returns the time, s UTC.
            recorder: Keeps raw samples; None: nobody does.
        """
        self.pipelines: dict[str, LoopPipeline] = {}
        self._gatherings = Gatherings(self._intake_of)
        self.connections: dict[str, Connection] = {}
        self.outboxes: dict[str, Outbox] = {}
        self.health: dict[str, Health] = {}
        """State of each loop's task."""
        self.orders = Orders(self.pipelines, journal, clock)
        self._journal = journal
        self._executor = executor
        self._diagnose = diagnose
        self._observers = observers
        self._clock = clock
        self._recorder = recorder
        self._kept: dict[str, Alarm] = {}
        self._remembered: dict[str, ValveMemory] = {}

    async def resume(self) -> None:
        """Restore alarms and unpublished messages from the store."""
        kept = await self._journal.open()
        self._kept = dict(kept.alarms)
        self._remembered = dict(kept.memories)
        for name, pipeline in self.pipelines.items():
            pipeline.resume(self._kept.get(name), self._remembered.get(name))
        for name in {each.target for each in kept.waiting.values()}:
            waiting = {n: each.publication for n, each in kept.waiting.items() if each.target == name}
            if name in self.outboxes:
                self.outboxes[name].restore(waiting)
            else:
                self._discard(name, waiting)
        for name in self._kept.keys() & self.pipelines.keys():
            self.pipelines[name].publish_again(self._clock())
        await self._journal.flush()

    def wire(
        self,
        settings: Settings,
        connectors: Mapping[str, Connector],
        loops: Collection[LoopSettings],
        *,
        at_work: bool,
    ) -> None:
        """Build these connections and loops, keep the others that are in the settings, drop the rest.

        ``at_work``: the store was read already, so new loops continue from the alarms it kept.
        """
        for name in self.outboxes.keys() - settings.connections.keys():
            self._discard(name, self.outboxes.pop(name).emptied())
        for name in settings.connections:
            self.outboxes.setdefault(name, Outbox(name, self._journal))
        groups = math.ceil(len(settings.loops) / TOGETHER)
        staggers = {loop.name: k // TOGETHER / groups for k, loop in enumerate(settings.loops)}
        changed = {loop.name: self._pipeline(loop, settings.agent, staggers[loop.name]) for loop in loops}
        former = dict(self.pipelines)
        for name, pipeline in changed.items():
            if name in former:
                pipeline.take_over(former[name])
            elif at_work:
                pipeline.resume(self._kept.get(name), self._remembered.get(name))
        self._remembered |= {name: pipeline.memory for name, pipeline in former.items()}
        self._kept |= {name: pipeline.alarm for name, pipeline in former.items()}
        self._gatherings.end()
        self.pipelines.clear()  # the same object still: others look loops up in it
        self.pipelines |= {loop.name: changed.get(loop.name) or former[loop.name] for loop in settings.loops}
        self.health = {
            name: self._loop_health(name) if name in changed else self.health[name] for name in self.pipelines
        }
        if at_work:
            for pipeline in self.pipelines.values():
                if any(target.connection in connectors for target in pipeline.settings.publish):
                    pipeline.publish_again(self._clock())
        plans = connection_plans(settings)
        self.connections = {
            name: self._connection(connectors[name], plan.data_age)
            if name in connectors
            else self.connections[name]
            for name, plan in plans.items()
        }

    def _intake_of(self, loop: str) -> Intake | None:
        pipeline = self.pipelines.get(loop)
        return None if pipeline is None else pipeline.intake

    def _discard(self, connection: str, waiting: Mapping[int, Publication]) -> None:
        """Discard publications for a connection that is no longer in the settings."""
        for publication in waiting.values():
            LOG.warning("connection %s is no longer configured: %s was discarded", connection, publication.id)
        self._journal.note(Change(removed=frozenset(waiting)))

    def _pipeline(self, loop: LoopSettings, agent: AgentSettings, stagger: float) -> LoopPipeline:
        return LoopPipeline(
            loop,
            self._executor,
            [self.outboxes[name] for name in dict.fromkeys(target.connection for target in loop.publish)],
            self._observers,
            self._diagnose,
            self._journal,
            None if agent.clock_error is None else SourceClock(loop.name, agent.clock_error, self._clock),
            agent.base_rate,
            self._recorder,
            stagger,
        )

    def _connection(self, connector: Connector, data_age: float) -> Connection:
        name, outbox = connector.name, self.outboxes[connector.name]

        def read() -> list[LoopPipeline]:
            return [each for each in self.pipelines.values() if each.settings.connection == name]

        def deliver(each: Sample | Readings) -> None:
            arrival = asyncio.get_running_loop().time()
            if isinstance(each, Readings):
                self._gatherings.put(each, arrival)
                return
            pipeline = self.pipelines.get(each.tag.loop)
            if pipeline is not None:
                pipeline.push(each, arrival)

        def interrupted() -> None:
            outbox.interrupt()
            self._gatherings.end()
            for pipeline in read():
                pipeline.window.interrupt()

        obey = functools.partial(self.orders.obey, name) if connector.takes_orders else None
        made = Connection(connector, outbox, deliver if read() else None, interrupted, data_age, obey)
        if name in self.connections:
            made.count_on(self.connections[name])
        return made

    def _loop_health(self, loop: str) -> Health:
        made = Health(f"loop {loop}", about={"loop": loop})
        if loop in self.health:
            made.count_on(self.health[loop])
        return made
