"""Checks the connections of a configuration: does the peer answer, are the values of its tags plausible?"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from agent.runtime.commission.plausibility import Reading, problems, remarks
from agent.settings import LoopSettings, Settings, connectors_of
from connectors.base import (
    AccessDeniedError,
    ChecksTargets,
    ConnectionLostError,
    Connector,
    LoopRole,
    Order,
    Session,
)
from connectors.cancellation import obey_cancellation


@dataclass(frozen=True, slots=True)
class Finding:
    """What came of a connection, of a tag that is read there, or of a place that would be written."""

    what: Literal["connection", "tag", "target"]
    connection: str
    loop: str = ""
    place: str = ""
    """Role of a tag; of a target, where it is in the bus's own words."""
    reading: Reading | None = None
    """Of a tag; None where nothing came."""
    problems: tuple[str, ...] = ()
    """What must be put right."""
    remarks: tuple[str, ...] = ()
    """What may be right, and should be known."""


async def probe(settings: Settings, within: float, watch: float = 0.0) -> tuple[Finding, ...]:
    """Open each connection, read all tags and look at all targets; writes and publishes nothing.

    Args:
        settings: What to try.
        within: How long to wait for a value of every tag, s.
        watch: How long to listen on after that, s: whether PV and clocks move shows only in time.
    """
    connectors = connectors_of(settings, guest=True)
    found = await asyncio.gather(*(_Probe(each, settings, within, watch).findings() for each in connectors))
    return tuple(finding for findings in found for finding in findings)


class _Probe:
    """One connection's."""

    def __init__(self, connector: Connector, settings: Settings, within: float, watch: float) -> None:
        self._connector = connector
        self._within = within
        self._watch = watch
        self._any_clock = settings.agent.clock_error is None
        self._tags: Mapping[LoopRole, tuple[LoopSettings, str]] = {
            LoopRole(loop.name, role): (loop, role)
            for loop in settings.loops
            if loop.connection == connector.name
            for role in loop.roles
        }
        self._published = [
            loop.name for loop in settings.loops if any(t.connection == connector.name for t in loop.publish)
        ]
        self._readings: dict[LoopRole, Reading] = {}
        self._targets: list[Finding] = []
        self._complete = False
        """Whether every tag has sent a value."""

    async def findings(self) -> list[Finding]:
        """Return what came of the connection, its tags and its targets, in this order."""
        name = self._connector.name
        opened, lost = False, None
        try:
            async with asyncio.timeout(self._within) as limit, self._connector.session() as session:
                opened = True
                self._targets = await self._looked_at(session)
                await self._read(session, limit)
        except AccessDeniedError as error:
            lost = f"refused: {error}"
        except ConnectionLostError as error:
            lost = f"lost: {error}" if opened else f"unreachable: {error}"
        except TimeoutError:
            lost = None if opened else f"unreachable: no answer within {self._within:g} s"
        unread = (
            "not read: no connection"
            if lost
            else f"no value within {self._within:g} s: it is not sent, or its address is wrong"
        )
        connection = Finding("connection", name, problems=(lost,) if lost else ())
        return [connection, *(self._tag(tag, unread) for tag in self._tags), *self._targets]

    async def _read(self, session: Session, limit: asyncio.Timeout) -> None:
        """Read until every tag has sent a value; continue until ``limit``, which is then extended."""
        if not self._tags:
            return
        async for each in session.samples():
            obey_cancellation()
            if isinstance(each, Order) or each.tag not in self._tags:
                continue
            former, now = self._readings.get(each.tag), time.time()
            self._readings[each.tag] = (
                Reading(each, now, each) if former is None else former.followed_by(each, now)
            )
            if not self._complete and self._tags.keys() <= self._readings.keys():
                if self._watch == 0:
                    return
                self._complete = True
                limit.reschedule(asyncio.get_running_loop().time() + self._watch)

    async def _looked_at(self, session: Session) -> list[Finding]:
        name = self._connector.name
        if isinstance(session, ChecksTargets):
            return [
                Finding(
                    "target",
                    name,
                    report.subject,
                    report.place,
                    problems=(report.problem,) if report.problem else (),
                    remarks=(report.remark,) if report.remark else (),
                )
                for report in await session.check_targets()
            ]
        remark = "cannot be checked without publishing"
        return [Finding("target", name, loop, remarks=(remark,)) for loop in self._published]

    def _tag(self, tag: LoopRole, missing: str) -> Finding:
        loop, role = self._tags[tag]
        reading = self._readings.get(tag)
        if reading is None:
            return Finding("tag", self._connector.name, loop.name, role, None, (missing,))
        return Finding(
            "tag",
            self._connector.name,
            loop.name,
            role,
            reading,
            problems(reading, role, loop, any_clock=self._any_clock),
            remarks(reading, role, loop, self._watch if self._complete else 0.0),
        )
