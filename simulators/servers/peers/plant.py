"""What the peers have in common that are simulated plants."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import AsyncIterator, Mapping
from contextlib import aclosing, asynccontextmanager
from typing import Any, Self, cast

from connectors.checks.peer import LOOPS, ROLES, Entry
from simulators.plant import Row
from simulators.servers.loop_server import LoopServer

TS = 1.0
"""Sampling time of the loops, s."""


class PlantPeer(ABC):
    """A plant on a bus, with the loops of the checks."""

    precision = 0.0
    frames: tuple[bytes, ...] = ()
    header = 40

    def __init__(self) -> None:
        self.port = 0
        self._server: LoopServer | None = None
        self._entries: dict[str, dict[str, Any]] = {}
        self._connection: dict[str, Any] = {}

    @abstractmethod
    def _make(self) -> LoopServer:
        """Return a server on ``port``, not entered."""

    @abstractmethod
    def _quick(self, wait: float) -> Entry:
        """Return the options that bound the waits of a connection."""

    @property
    def lead(self) -> int:
        """Rows of a loop that may wait."""
        return self._made.lead

    async def __aenter__(self) -> Self:
        """Start."""
        await self.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        """Stop for good."""
        await self.stop()

    async def start(self) -> None:
        """Start, on the same port as before."""
        server = self._make()
        await server.__aenter__()
        self._server = server
        self.port = cast("Any", server).port
        self._connection = {
            key: value for key, value in server.connection_settings().items() if key != "kind"
        }
        self._entries = {loop: server.loop_settings(loop, TS) for loop in LOOPS}

    async def stop(self) -> None:
        """Go away."""
        if self._server is not None:
            server, self._server = self._server, None
            await server.__aexit__(None, None, None)

    async def put(self, loop: str, time: float, values: Mapping[str, float | str]) -> None:
        """Show a row."""
        await self._made.put(loop, Row(time, dict(values)))

    def connection(self, port: int | None = None, *, wait: float = 1.0) -> Entry:
        """Return the entry of ``connections``."""
        return {**self._connection, **self._place(self.port if port is None else port), **self._quick(wait)}

    def loop(self, name: str) -> Entry:
        """Return tags and targets of a loop."""
        entry = self._entries[name]
        targets = [
            {key: value for key, value in each.items() if key != "connection"} for each in entry["publish"]
        ]
        return {"tags": entry["tags"], "publish": targets}

    @asynccontextmanager
    async def alarms(self) -> AsyncIterator[AsyncIterator[tuple[str, bool]]]:
        """Observe alarms; every bus of a plant keeps the newest state, so none is missed."""
        async with aclosing(self._made.watch_alarms()) as alarms:  # type: ignore[type-var]
            yield alarms

    def _place(self, port: int) -> Entry:
        return {"host": "127.0.0.1", "port": port}

    @property
    def _made(self) -> LoopServer:
        if self._server is None:
            raise RuntimeError("the peer is stopped")
        return self._server


ROLES_OF = dict.fromkeys(LOOPS, ROLES)
"""Loop -> roles, as servers of plants take them."""
