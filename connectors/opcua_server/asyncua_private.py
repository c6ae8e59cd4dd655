"""Every member of asyncua that its documentation does not list and this server needs: here and nowhere else.

asyncua 2.1 offers no public way to any of them. A newer version may rename them without notice; ``missing``
then names what is gone, and only this file has to change.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from asyncua import ua
from asyncua.common.connection import SecureConnection
from asyncua.server.binary_server_asyncio import BinaryServer, OPCUAProtocol
from asyncua.server.internal_server import InternalServer
from asyncua.server.internal_session import InternalSession
from asyncua.server.internal_subscription import InternalSubscription
from asyncua.server.monitored_item_service import (
    MonitoredItemData,
    MonitoredItemService,
    WhereClauseEvaluator,
)
from asyncua.server.uaprocessor import UaProcessor

MEMBERS: tuple[tuple[type, tuple[str, ...]], ...] = (
    (BinaryServer, ("_server", "_policies", "_make_protocol")),
    (OPCUAProtocol, ("_buffer",)),
    (UaProcessor, ("_connection", "_transport", "_process_message")),
    (SecureConnection, ("_incoming_parts",)),
    (InternalServer, ("_external_sessions",)),
    (MonitoredItemService, ("_monitored_items", "_monitored_events", "_trigger_event")),
    (WhereClauseEvaluator, ("_eval_el", "_eval_op", "_aspace")),
)
"""Class of asyncua -> its members that are used below."""


def missing() -> list[str]:
    """Return the members that the installed asyncua does not have, e.g. ``BinaryServer._server``."""
    return [f"{owner.__name__}.{name}" for owner, names in MEMBERS for name in names if not _has(owner, name)]


def _has(owner: Any, name: str) -> bool:  # noqa: ANN401 - asyncua has no types
    """Return whether the class defines the member or its constructor sets it."""
    return hasattr(owner, name) or name in owner.__init__.__code__.co_names


def is_listening(listener: BinaryServer) -> bool:
    """Return whether the listening socket is open; asyncua has no public state of it."""
    server: asyncio.Server | None = listener._server  # noqa: SLF001
    return server is not None and server.is_serving()


def make_connections_with(listener: BinaryServer, make: Callable[[], OPCUAProtocol]) -> None:
    """Have ``make`` build the protocol of each new connection; asyncua has no parameter for its class."""
    listener._make_protocol = make  # noqa: SLF001


def client_sessions(server: InternalServer) -> list[InternalSession]:
    """Return the sessions of all clients, also of those that have vanished; asyncua has no list of them."""
    return list(server._external_sessions.values())  # noqa: SLF001


def monitored_items(subscription: InternalSubscription) -> Mapping[int, MonitoredItemData]:
    """Return id -> monitored item of a subscription, a live view: asyncua neither counts nor lists them."""
    items: Mapping[int, MonitoredItemData] = subscription.monitored_item_srv._monitored_items  # noqa: SLF001
    return items


def event_items(subscription: InternalSubscription) -> Mapping[ua.NodeId, Iterable[int]]:
    """Return node -> ids of the items that subscribe to its events, a live view, for the same reason."""
    items: Mapping[ua.NodeId, Iterable[int]] = subscription.monitored_item_srv._monitored_events  # noqa: SLF001
    return items


async def send_event(subscription: InternalSubscription, event: Any, item: int) -> None:  # noqa: ANN401
    """Put an event through the filter of one monitored item; asyncua itself chooses the items by one node."""
    await subscription.monitored_item_srv._trigger_event(event, item)  # noqa: SLF001


class ConnectionProtocol(OPCUAProtocol):  # type: ignore[misc]
    """One connection whose bytes of an incomplete frame can be seen: asyncua never checks them."""

    def __init__(self, listener: BinaryServer) -> None:
        super().__init__(
            listener.iserver,
            listener._policies,  # noqa: SLF001
            listener.clients,
            listener.closing_tasks,
            listener.limits,
        )
        self._buffer: bytes

    @property
    def incomplete_frame(self) -> bytes:
        """Bytes that wait for the rest of their frame."""
        return self._buffer

    def discard_frame(self) -> None:
        """Discard these bytes."""
        self._buffer = b""


class MessageProcessor(UaProcessor):  # type: ignore[misc]
    """Answers the messages of one connection; ``answer`` can be overridden, its counterpart is private."""

    @property
    def has_incomplete_message(self) -> bool:
        """Whether a message has begun whose last chunk has not come."""
        return bool(self._connection._incoming_parts)  # noqa: SLF001

    def close_transport(self) -> None:
        """Close the connection to the client; asyncua closes the session only."""
        self._transport.close()

    async def answer(self, *message: Any) -> Any:  # noqa: ANN401
        """Answer a request; returns whether the connection goes on."""
        return await super()._process_message(*message)

    async def _process_message(self, *message: Any) -> Any:  # noqa: ANN401
        return await self.answer(*message)


class FilterEvaluator(WhereClauseEvaluator):  # type: ignore[misc]
    """Filter of events; ``evaluate`` can be overridden, its counterpart is private."""

    @property
    def space(self) -> Any:  # noqa: ANN401
        """Address space in which types are looked up."""
        return self._aspace

    def operand(self, operand: Any, event: Any) -> Any:  # noqa: ANN401
        """Return the value of an operand for an event."""
        return self._eval_op(operand, event)

    def evaluate(self, index: int, event: Any) -> Any:  # noqa: ANN401
        """Return the value of the ``index``-th element for an event."""
        return super()._eval_el(index, event)

    def _eval_el(self, index: int, event: Any) -> Any:  # noqa: ANN401
        return self.evaluate(index, event)
