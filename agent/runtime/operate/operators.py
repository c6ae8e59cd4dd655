"""Executes commands that people left in the store, and ends shelving in time."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Mapping
from typing import NoReturn

from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.store.change import Change
from agent.runtime.store.journal import Journal
from agent.runtime.store.store import StoredCommand
from agent.runtime.supervisor import MARGIN, Health
from connectors.cancellation import obey_cancellation

LOG = logging.getLogger(__name__)
LOOK = 1.0
"""Time between two looks for commands and at the end of shelving, s. A look costs 0.8 ms of CPU: two a
second were half of the CPU of an agent of 100 loops over Modbus."""


class Operators:
    """Executes the commands that `slipjump alarms` leaves in the store. ``run`` is for a supervisor."""

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
            for stored in await self._journal.commands():
                self._obey(stored)
            now = self._clock()
            shelved = [each for each in self._pipelines.values() if each.alarm.until is not None]
            for pipeline in shelved:
                pipeline.look_at_clock(now)
            await self._journal.flush()
            obey_cancellation()
            await asyncio.sleep(LOOK)

    def _obey(self, stored: StoredCommand) -> None:
        pipeline = self._pipelines.get(stored.loop)
        if pipeline is None or stored.command is None:
            LOG.warning("command %d for %s cannot be obeyed", stored.number, stored.loop)
        else:
            about = {"event": "order", "loop": stored.loop}
            LOG.info("%s: %s by %s", stored.loop, stored.command.event, stored.command.by, extra=about)
            pipeline.obey(stored.command)
        self._journal.note(Change(taken=frozenset({stored.number})))
