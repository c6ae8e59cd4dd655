"""One part of the loops of a configuration, for one agent of several: each loop is in exactly one part."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from hashlib import blake2b
from typing import TYPE_CHECKING

from connectors.base import ConfigError

if TYPE_CHECKING:
    from agent.settings.models import ConnectionSettings, LoopSettings, Settings

NAMED = ("client", "node")
"""Options that name this program to a peer; two parts must not have the same name there."""


@dataclass(frozen=True, slots=True)
class Partition:
    """Part ``number`` of ``of``, counted from 1."""

    number: int
    of: int

    @classmethod
    def parse(cls, text: str) -> Partition:
        """Return what ``2/5`` means; raises ConfigError."""
        found = re.fullmatch(r"(\d{1,4})/(\d{1,4})", text.strip())
        number, of = (int(each) for each in found.groups()) if found else (0, 0)
        if not 1 <= number <= of:
            raise ConfigError([f"--partition: expected part/parts, such as 2/5, not {text!r}"])
        return cls(number, of)

    def has(self, loop: str) -> bool:
        """Whether a loop is in this part: by its name alone, so that other loops may come and go."""
        return (
            int.from_bytes(blake2b(loop.encode(), digest_size=8).digest(), "big") % self.of == self.number - 1
        )

    def of_settings(self, settings: Settings) -> Settings:
        """Return the settings of the agent that has this part; raises ConfigError where it has no loop.

        Connections without a loop are left out; the state file and the name on a broker get the number.
        """
        loops = tuple(loop for loop in settings.loops if self.has(loop.name))
        if not loops:
            raise ConfigError([f"--partition: part {self.number} of {self.of} has no loop"])
        used = {name for loop in loops for name in _connections(loop)}
        state = settings.agent.state
        if state is not None:
            state = state.with_name(f"{state.stem}.{self.number}of{self.of}{state.suffix}")
        return replace(
            settings,
            agent=settings.agent.model_copy(update={"state": state}),
            connections=self._named({n: each for n, each in settings.connections.items() if n in used}),
            loops=loops,
        )

    def _named(self, connections: Mapping[str, ConnectionSettings]) -> dict[str, ConnectionSettings]:
        found = {}
        for name, each in connections.items():
            names = {key: getattr(each.options, key, None) for key in NAMED}
            update = {key: f"{value}-{self.number}" for key, value in names.items() if value}
            found[name] = replace(each, options=each.options.model_copy(update=update))
        return found


def _connections(loop: LoopSettings) -> list[str]:
    return [loop.connection, *(target.connection for target in loop.publish)]
