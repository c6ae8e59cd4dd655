"""What people left in the store for a running agent, and shelving that ends."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Mapping
from typing import NoReturn

from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.store.change import Change
from agent.runtime.store.journal import Journal
from agent.runtime.store.store import Told
from agent.runtime.supervisor import MARGIN, Health
from connectors.cancellation import obey_cancellation

LOG = logging.getLogger(__name__)
LOOK = 0.5
"""Time between two looks for commands and at the end of shelving, s."""


class Operators:
    """Obeys `slipjump alarms`, which knows the agent by its store only. ``run`` is for a supervisor."""

    def __init__(
        self, pipelines: Mapping[str, LoopPipeline], journal: Journal, clock: Callable[[], float]
    ) -> None:
        """Make it.

        Args:
            pipelines: By loop.
            journal: Has the commands.
            clock: Gives the time, s UTC.
        """
        self.health = Health("commands of operators")
        self._pipelines = pipelines
        self._journal = journal
        self._clock = clock

    async def run(self) -> NoReturn:
        """Look now and then, until cancelled."""
        while True:
            self.health.expect("look", MARGIN)
            for told in await self._journal.commands():
                self._obey(told)
            now = self._clock()
            for pipeline in self._pipelines.values():
                pipeline.look_at_clock(now)
            await self._journal.flush()
            obey_cancellation()
            await asyncio.sleep(LOOK)

    def _obey(self, told: Told) -> None:
        pipeline = self._pipelines.get(told.loop)
        if pipeline is None or told.command is None:
            LOG.warning("command %d for %s cannot be obeyed", told.number, told.loop)
        else:
            about = {"event": "order", "loop": told.loop}
            LOG.info("%s: %s by %s", told.loop, told.command.event, told.command.by, extra=about)
            pipeline.obey(told.command)
        self._journal.note(Change(taken=frozenset({told.number})))
