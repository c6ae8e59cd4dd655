"""What every server of plants offers, whatever its bus."""

from __future__ import annotations

from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import AbstractAsyncContextManager
from typing import Any, Protocol, Self

from simulators.plant import Row
from simulators.source import Source

Entry = dict[str, Any]
"""A part of slipjump's configuration file."""
ALARM_FIELDS = ("f_s", "f_d", "s", "j")
"""Numbers of an alarm that the servers have a place for."""


class LoopServer(AbstractAsyncContextManager["LoopServer"], Protocol):
    """Shows the newest row of every loop on a bus and takes alarms back.

    Entering it raises OSError, with one line that names host and port, where it cannot listen or connect.
    """

    lead: int
    """Rows of a loop that may wait for its reader without being lost."""
    name: str
    """Name of the connection in the entries below."""

    async def __aenter__(self) -> Self:
        """Begin to serve."""
        ...

    async def put(self, loop: str, row: Row) -> None:
        """Show this row from now on."""
        ...

    def connection_settings(self) -> Entry:
        """Return the entry of ``connections`` that reaches this server."""
        ...

    def loop_settings(self, loop: str, ts: float) -> Entry:
        """Return the entry of ``loops`` that reads the loop from here, and publishes its alarm here."""
        ...

    def watch_alarms(self) -> AsyncIterator[tuple[str, bool]]:
        """Yield (loop, is its alarm active) whenever a client of its own sees so on the bus."""
        ...


def loop_entry(name: str, loop: str, ts: float, tags: Mapping[str, Entry], target: Entry) -> Entry:
    """Return an entry of ``loops`` whose tags and alarm are on the connection ``name``."""
    return {
        "name": loop,
        "connection": name,
        "ts": ts,
        "tags": dict(tags),
        "publish": [{"connection": name, **target}],
    }


def roles_of(sources: Sequence[Source]) -> dict[str, tuple[str, ...]]:
    """Return loop -> the roles that its rows carry, as servers want to know beforehand."""
    return {source.loop: tuple(next(source.rows()).values) for source in sources}
