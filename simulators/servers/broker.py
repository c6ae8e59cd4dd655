"""An MQTT broker inside this process, for demo and replay where none runs."""

from __future__ import annotations

import logging
from asyncio import StreamReader, StreamWriter
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from amqtt.broker import Broker
from amqtt.errors import BrokerError

for library in ("amqtt", "transitions"):
    logging.getLogger(library).setLevel(
        logging.CRITICAL
    )  # a client that comes and goes is not worth a log line


class _Broker(Broker):  # type: ignore[misc]  # amqtt has no types
    """amqtt's, whose socket to a client stayed open where its closing was interrupted."""

    async def stream_connected(self, reader: StreamReader, writer: StreamWriter, listener_name: str) -> None:
        """Serve one client."""
        try:
            await super().stream_connected(reader, writer, listener_name)
        finally:
            writer.close()


@asynccontextmanager
async def embedded_broker(host: str = "127.0.0.1", port: int = 0) -> AsyncIterator[int]:
    """Run a broker and yield its port; port 0 takes any that is free. Raises OSError."""
    broker = _Broker(
        {
            "listeners": {"default": {"type": "tcp", "bind": f"{host}:{port}"}},
            "plugins": {"amqtt.plugins.authentication.AnonymousAuthPlugin": {"allow_anonymous": True}},
        }
    )
    try:
        await broker.start()
    except BrokerError as error:
        raise OSError(f"MQTT broker: cannot listen on {host}:{port}") from error
    try:
        listener = broker._servers["default"].instance  # noqa: SLF001 - the only place that knows a port it chose
        yield listener.sockets[0].getsockname()[1]
    finally:
        await broker.shutdown()
