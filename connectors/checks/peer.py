"""The other end of a bus in a check: a device, broker or client on loopback that the check controls."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import AbstractAsyncContextManager
from typing import Any, Protocol

LOOPS = ("FIC101", "TIC102")
"""Loops that every peer has."""
ROLES = ("pv", "op", "sp", "mode")
"""Roles of their values; a mode is a text or its number."""
Entry = Mapping[str, Any]
"""A part of the configuration file."""


class Peer(Protocol):
    """What a connector talks to in a check. One that is entered is started; leaving it stops it for good."""

    @property
    def port(self) -> int:
        """Port it listens on; where the connector is the server, the port on which the connector listens."""
        ...

    @property
    def lead(self) -> int:
        """Rows of a loop that may wait for the connector without being lost; 0: each must be read first."""
        ...

    @property
    def precision(self) -> float:
        """Largest relative error of a value on this bus; 0: values arrive as they are."""
        ...

    @property
    def frames(self) -> tuple[bytes, ...]:
        """Valid frames that the other side of the connector sends first; checks change them.

        Where there are none, checks send random bytes.
        """
        ...

    @property
    def header(self) -> int:
        """Bytes from the start of a frame of which any change makes it invalid."""
        ...

    def connection(self, port: int | None = None, *, wait: float = 1.0) -> Entry:
        """Return the entry of ``connections`` without ``kind``.

        Args:
            port: Of a proxy that stands before this peer; None: the peer's own.
            wait: Longest wait for an answer, s. Silence of the peer should be noticed within 5 s.
        """
        ...

    def loop(self, name: str) -> Entry:
        """Return the keys ``tags`` (role -> entry; empty where nothing is read) and ``publish`` (entries)."""
        ...

    async def start(self) -> None:
        """Start again after ``stop``, on the same port."""
        ...

    async def stop(self) -> None:
        """Go away; every connection ends."""
        ...

    async def put(self, loop: str, time: float, values: Mapping[str, float | str]) -> None:
        """Show the values of a loop, role -> value, measured at ``time`` (s UTC); NaN is a missing value.

        Never called where the kind of connector reads nothing.
        """
        ...

    def alarms(self) -> AbstractAsyncContextManager[AsyncIterator[tuple[str, bool]]]:
        """Observe with a client of its own what is published; once entered, no later change is missed.

        The iterator yields (loop, whether its alarm is active) at each change, and may repeat itself.
        """
        ...


PeerFactory = Callable[[], AbstractAsyncContextManager[Peer]]
"""Makes a peer with ``LOOPS`` that nobody used before, on a free port of 127.0.0.1."""
