"""What has changed since the store was last written, as a value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from agent.alarms import Alarm
from agent.analysis.memory.valve_memory import ValveMemory
from connectors.base import Publication


@dataclass(frozen=True, slots=True)
class Waiting:
    """A publication that its target has not taken yet."""

    target: str
    """Name of the connection."""
    publication: Publication


@dataclass(frozen=True, slots=True)
class Change:
    """What goes into the store in one transaction: all of it or nothing."""

    alarms: Mapping[str, Alarm] = field(default_factory=dict)
    """Loop -> its alarm as it is now."""
    put: Mapping[int, Waiting] = field(default_factory=dict)
    """Sequence number -> what waits from now on."""
    removed: frozenset[int] = frozenset()
    """Sequence numbers of what waits no longer."""
    memories: Mapping[str, ValveMemory] = field(default_factory=dict)
    """Loop -> what is remembered of its valve."""
    taken: frozenset[int] = frozenset()
    """Numbers of the commands that were obeyed."""

    def followed_by(self, later: Change) -> Change:
        """Return the change that does both.

        It never grows beyond what the store would hold: what was put and removed again leaves no trace.
        """
        return Change(
            {**self.alarms, **later.alarms},
            {
                number: each
                for number, each in {**self.put, **later.put}.items()
                if number not in later.removed
            },
            self.removed | (later.removed - self.put.keys()),
            {**self.memories, **later.memories},
            self.taken | later.taken,
        )
