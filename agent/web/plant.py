"""The running agent as screens see it: looks, live streams, calculations on demand, and who decided what."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

from agent.alarms import Alarm, Announcement
from agent.report.diagnosis_json import diagnosis_json
from agent.report.ranking import GROUPS, group_of
from agent.runtime.agent import Agent
from agent.runtime.loop.judged import Judged
from agent.runtime.operate.breath import breathing, in_order
from agent.runtime.operate.status import AgentStatus
from agent.runtime.store.database import StoreError
from agent.runtime.store.history_file import Entry, HistoryFile, history_path
from agent.runtime.supervisor import Health
from agent.web.judgement import KEY, Judgement, PersonalJudgement, standing
from agent.web.live import Live
from agent.web.pictures.drawing import Drawing
from agent.web.ranking import Item, area_of, urgency, widest

REMEMBERED = 20_000
"""Entries of history that are kept in memory where no file keeps them, of all loops together."""
READ = 3000
"""Entries of history that a page gets at most."""
ALARM_KEYS = ("state", "active", "by", "until", "s", "id")


@dataclass(frozen=True)
class Look:
    """The plant at a moment."""

    time: float
    """s UTC"""
    items: tuple[Item, ...]
    """All loops, what needs somebody first."""
    status: AgentStatus
    by_name: dict[str, Item]
    counts: dict[str, int]
    """Loops of each group, and those that are stale."""
    widest: float | None
    """Upper end of the widest interval of S of all loops, OP units; None where there is none."""

    @classmethod
    async def of(cls, time: float, items: tuple[Item, ...], status: AgentStatus) -> Self:
        """Count the items, a few at a time, once for all pages."""
        by_name: dict[str, Item] = {}
        counts = dict.fromkeys([*GROUPS, "stale"], 0)
        width = None
        async for item in breathing(items):
            by_name[item.status.loop] = item
            counts[item.group] += 1
            counts["stale"] += item.stale
            width = widest([item], width)
        return cls(time, items, status, by_name, counts, width)


class Plant:
    """What the screens share. It observes the agent from its making on."""

    def __init__(self, agent: Agent, clock: Callable[[], float] = time.time) -> None:
        """Make it.

        Args:
            agent: Not running yet.
            clock: Gives the time, s UTC.
        """
        self.agent = agent
        self.clock = clock
        self.live: Live[Look] = Live(self.look)
        self._looking = asyncio.Lock()
        self.drawing = Drawing()
        self.judgements = _kept_judgements(agent)
        """Of people, by loop."""
        self._since: dict[str, tuple[str, float]] = {}
        self._entries: deque[Entry] = deque(maxlen=REMEMBERED)
        agent.observe(self)
        agent.accompany(self.live.health, self.live.run)
        agent.accompany(Health("drawing"), self.drawing.run)

    def judged(self, judged: Judged) -> None:
        """Take the verdict on a window."""
        diagnosis = judged.diagnosis
        former = self._since.get(diagnosis.loop)
        if former is None or former[0] != diagnosis.verdict:
            self._since[diagnosis.loop] = (diagnosis.verdict, judged.end)
        if self.agent.history is None:
            content = diagnosis_json(diagnosis, "")
            kept = {name: content[name] for name in ("verdict", "cause", "confidence", "stiction")}
            self._entries.append(Entry(judged.end, diagnosis.loop, "diagnosis", kept))

    def announced(self, announcement: Announcement) -> None:
        """Take a change of an alarm."""
        if self.agent.history is None:
            fields = announcement.fields()
            kept = {name: fields[name] for name in ALARM_KEYS}
            self._entries.append(Entry(announcement.time, announcement.alarm.loop, "alarm", kept))

    async def look(self) -> Look:
        """Look at all loops and rank them, a few at a time.

        One look after the other: none that began before a decision reaches a page after one that shows it.
        """
        async with self._looking:
            return await self._look()

    async def _look(self) -> Look:
        status, pipelines = await self.agent.looked(), self.agent.pipelines
        found = []
        async for each in breathing(status.loops):
            pipeline = pipelines.get(each.loop)
            if pipeline is None:
                continue  # the configuration changed meanwhile
            judgement = self.judgements.get(each.loop)
            group = group_of(each.diagnosis) if judgement is None else judgement.group
            area = area_of(each.loop, pipeline.settings.variables)
            since = self._since_of(each.loop, pipeline.alarm)
            key = (*urgency(each, pipeline.alarm, group), each.loop)
            found.append((key, (each, pipeline.alarm, group, area, since), judgement))
        found = await in_order(found, lambda ranked: ranked[0])
        items = tuple(
            [
                Item(*known, spot, judgement)
                async for spot, (_, known, judgement) in breathing(enumerate(found))
            ]
        )
        return await Look.of(self.clock(), items, status)

    def judge(self, loop: str, said: PersonalJudgement) -> None:
        """Keep what a person says of a valve, or withdraw it."""
        content = {KEY: said.judgement, "by": said.by.strip(), "comment": said.comment}
        self.note(loop, {"action": f"judged: {said.judgement}", **content})
        entry = Entry(self.clock(), loop, "note", content)
        self.judgements.pop(loop, None)
        self.judgements |= standing([entry])

    def note(self, loop: str, content: dict[str, Any]) -> None:
        """Keep what a person decided about a loop."""
        entry = Entry(self.clock(), loop, "note", content)
        if self.agent.history is None:
            self._entries.append(entry)
        else:
            self.agent.history.noted(entry)

    async def history(self, loop: str | None, since: float | None = None) -> tuple[Entry, ...]:
        """Return what was kept of a loop, or of all, the oldest first."""
        state = self.agent.settings.agent.state
        if self.agent.history is None or state is None:
            entries = [each for each in self._entries if loop in (None, each.loop)]
            return tuple(each for each in entries if since is None or each.time >= since)[-READ:]

        def read() -> tuple[Entry, ...]:
            try:
                file = HistoryFile(history_path(state), create=False)
            except StoreError:
                return ()  # nothing was written yet
            try:
                return file.read(loop, since, READ)
            finally:
                file.close()

        return await asyncio.to_thread(read)

    def _since_of(self, loop: str, alarm: Alarm) -> float | None:
        known = self._since.get(loop)
        if alarm.state.active and alarm.id is not None:
            return float(alarm.id.rpartition("/")[2])
        return None if known is None else known[1]


def _kept_judgements(agent: Agent) -> dict[str, Judgement]:
    """Return what people said before the agent was started again; none where nothing was kept."""
    state = agent.settings.agent.state
    if state is None or agent.history is None or not history_path(state).exists():
        return {}
    try:
        file = HistoryFile(history_path(state), create=False)
    except StoreError:
        return {}
    try:
        return standing(file.notes())
    finally:
        file.close()
