"""Tries the connections of a configuration once: is the peer there, and does each tag give a value?"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass

from agent.settings import Settings, connectors_of
from connectors.base import ConnectionLostError, Connector, Order, Quality, Sample, Session
from connectors.cancellation import obey_cancellation


@dataclass(frozen=True, slots=True)
class Finding:
    """What came of a connection or of one of its tags."""

    connection: str
    tag: str | None
    """``LOOP.ROLE``; None for the connection itself."""
    sample: Sample | None
    """The first one of the tag."""
    problem: str | None
    """Why it does not work; None where it does."""


async def probe(settings: Settings, within: float) -> tuple[Finding, ...]:
    """Open each connection and wait up to ``within`` seconds for a sample of every tag; publishes nothing."""
    found = await asyncio.gather(
        *(_probe(connector, settings, within) for connector in connectors_of(settings))
    )
    return tuple(finding for findings in found for finding in findings)


async def _probe(connector: Connector, settings: Settings, within: float) -> list[Finding]:
    name = connector.name
    tags = [
        f"{loop.name}.{role}" for loop in settings.loops if loop.connection == name for role in loop.roles
    ]
    samples: dict[str, Sample] = {}
    opened, problem = False, f"no answer within {within:g} s"
    try:
        async with asyncio.timeout(within), connector.session() as session:
            opened, problem = True, f"no value within {within:g} s"
            await _collect(session, set(tags), samples)
    except ConnectionLostError as error:
        problem = str(error)
    except TimeoutError:
        pass  # ``problem`` says how far it came
    return [
        Finding(name, None, None, None if opened else problem),
        *(Finding(name, tag, samples.get(tag), _fault(samples.get(tag), problem)) for tag in tags),
    ]


async def _collect(session: Session, tags: set[str], samples: dict[str, Sample]) -> None:
    """Put the first sample of each tag into ``samples``."""
    if not tags:
        return
    async for each in session.samples():
        if not isinstance(each, Order):
            samples.setdefault(each.tag, each)
        obey_cancellation()
        if tags <= samples.keys():
            return


def _fault(sample: Sample | None, problem: str) -> str | None:
    if sample is None:
        return problem
    return f"bad quality, code {sample.code:#x}" if sample.quality is Quality.BAD else None
