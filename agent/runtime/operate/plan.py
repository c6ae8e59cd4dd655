"""What of a running agent a changed configuration concerns; pure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from agent.settings import AgentSettings, ConnectionSettings, LoopSettings, Settings, tags_on
from connectors.options import LoopTags

AT_START = ("workers", "state", "clock_error", "base_rate", "http", "history", "watch_config")
"""Settings of the agent that take effect when it starts."""
SILENT_SAMPLES = 5
"""Sampling times without any sample that make silence, where ``agent.data_age`` is shorter."""


@dataclass(frozen=True, slots=True)
class ConnectionPlan:
    """All that decides how a connection is run: where it stays the same, the session goes on."""

    settings: ConnectionSettings
    loops: tuple[tuple[str, LoopTags[Any, Any]], ...]
    """What is read and written there, by loop, in the order of the file, which may decide addresses."""
    data_age: float
    """Time without a sample after which the peer counts as gone, s."""
    longest_wait: float
    """s"""


@dataclass(frozen=True, slots=True)
class Difference:
    """From one configuration to the next."""

    loops: frozenset[str]
    """Names of those that changed, came or went."""
    connections: frozenset[str]
    """Likewise."""
    at_start: tuple[str, ...]
    """Settings of the agent that changed and take effect at its next start only."""


def difference(old: Settings, new: Settings) -> Difference:
    """Return what differs."""
    return Difference(
        _changed({loop.name: loop for loop in old.loops}, {loop.name: loop for loop in new.loops}),
        _changed(connection_plans(old), connection_plans(new)),
        tuple(name for name in AT_START if getattr(old.agent, name) != getattr(new.agent, name)),
    )


def connection_plans(settings: Settings) -> dict[str, ConnectionPlan]:
    """Return how each connection is to be run, by its name."""
    return {
        name: ConnectionPlan(
            connection,
            tuple(tags_on(settings, name).items()),
            max(
                (silence(loop, settings.agent) for loop in settings.loops if loop.connection == name),
                default=settings.agent.data_age,
            ),
            settings.agent.longest_wait,
        )
        for name, connection in settings.connections.items()
    }


def silence(loop: LoopSettings, agent: AgentSettings) -> float:
    """Time without a sample of a loop after which something is wrong, s."""
    return max(agent.data_age, SILENT_SAMPLES * loop.ts)


def _changed(old: Mapping[str, object], new: Mapping[str, object]) -> frozenset[str]:
    return frozenset(name for name in old.keys() | new.keys() if old.get(name) != new.get(name))
