"""Turns orders that people send over the buses into commands to the loop's alarm."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping

from agent.alarms import Command
from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.store.journal import Journal
from connectors.base import Order

LOG = logging.getLogger(__name__)


class Orders:
    """Executes orders; a refused one is counted, and logged once while the reason is the same."""

    def __init__(
        self, pipelines: Mapping[str, LoopPipeline], journal: Journal, clock: Callable[[], float]
    ) -> None:
        """Make it.

        Args:
            pipelines: By loop.
            journal: Written after each order.
            clock: Gives the time, s UTC.
        """
        self.taken = 0
        """Orders that changed an alarm."""
        self.refused = 0
        """Orders for a loop or an activation that is not there, or that mean nothing as the alarm stands."""
        self._pipelines = pipelines
        self._journal = journal
        self._clock = clock
        self._problem = ""

    async def obey(self, connection: str, order: Order) -> None:
        """Execute an order received over ``connection``, and return when the result is on disk."""
        await self.decide(connection, order)

    async def decide(self, connection: str, order: Order) -> str | None:
        """Execute it as ``obey`` does; return why it was refused, None where it was not."""
        problem = self._obey(order)
        about = {"event": "order", "connection": connection, "loop": order.subject}
        if problem is None:
            self.taken += 1
            LOG.info("%s: %s by %r, over %s", order.subject, order.action, order.by, connection, extra=about)
            await self._journal.flush()
            return None
        self.refused += 1
        message = f"{order.action} of {order.subject!r} by {order.by!r}, over {connection}: {problem}"
        if message != self._problem:
            self._problem = message
            LOG.warning("%s", message, extra=about)
        return problem

    def _obey(self, order: Order) -> str | None:
        """Pass it to its loop; return the reason if that fails."""
        pipeline = self._pipelines.get(order.subject)
        if pipeline is None:
            return "there is no such loop"
        if order.alarm is not None and order.alarm != pipeline.alarm.id:
            return f"it is meant for {order.alarm!r}, and the alarm is {pipeline.alarm.id!r} now"
        try:
            command = Command.of_action(order.action, order.by, self._clock(), order.until)
        except ValueError as error:
            return str(error)
        before = pipeline.alarm
        pipeline.obey(command)
        return f"means nothing while it is {before.state}" if pipeline.alarm == before else None
