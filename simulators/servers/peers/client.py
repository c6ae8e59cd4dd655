"""What the peers have in common that are clients of a server of ours."""

from __future__ import annotations

import socket
from collections.abc import Mapping
from typing import Self

from connectors.checks.peer import Entry


class ClientPeer:
    """A client: the connector listens on ``port``, and there is nothing to start or stop."""

    lead = 0
    precision = 0.0
    frames: tuple[bytes, ...] = ()
    header = 8

    def __init__(self) -> None:
        self.port = 0

    async def __aenter__(self) -> Self:
        """Choose a free port."""
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        return self

    async def __aexit__(self, *_: object) -> None:
        """End."""

    async def start(self) -> None:
        """Do nothing: a client comes when it observes."""

    async def stop(self) -> None:
        """Do nothing."""

    async def put(self, loop: str, time: float, values: Mapping[str, float | str]) -> None:
        """Refuse: nothing is read from clients."""
        raise NotImplementedError

    def connection(self, port: int | None = None, *, wait: float = 1.0) -> Entry:  # noqa: ARG002
        """Return the entry of ``connections``."""
        return {"port": self.port if port is None else port}

    def loop(self, name: str) -> Entry:  # noqa: ARG002
        """Return the target of a loop."""
        return {"tags": {}, "publish": [{}]}
