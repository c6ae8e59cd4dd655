"""Every member of asyncua that its documentation does not list and this client needs: here only."""

from __future__ import annotations

import struct
from datetime import UTC, datetime, timedelta
from typing import Any

from asyncua import ua
from asyncua.client.ua_session import UaSession
from asyncua.common.utils import Buffer
from asyncua.ua.ua_binary import struct_from_binary

from connectors.opcua.notification import PlainResponse, read_response

MEMBERS: tuple[tuple[type, tuple[str, ...]], ...] = ((UaSession, ("_send_request",)),)
"""Class of asyncua -> its members that are used below."""
_BEGINS = datetime(1601, 1, 1, tzinfo=UTC)
_UNREADABLE = (ua.UaError, ValueError, TypeError, LookupError, ArithmeticError, RecursionError, struct.error)
"""What asyncua's decoder raises for bytes that no server may send."""


def missing() -> list[str]:
    """Return the members that the installed asyncua does not have."""
    return [
        f"{owner.__name__}.{name}" for owner, names in MEMBERS for name in names if not hasattr(owner, name)
    ]


class _Answered:
    """Stands for a session that has its answer, so that asyncua decodes it, and reports what it cannot."""

    def __init__(self, session: UaSession, answer: Buffer) -> None:
        self.logger = session.logger
        self._answer = answer

    async def _send_request(self, _request: Any, **_: Any) -> Buffer:  # noqa: ANN401
        return self._answer


def publish_fast(session: UaSession) -> None:
    """Have a session put ``NodeChanges`` in the place of each DataChangeNotification that is plain."""

    async def publish(acknowledged: list[ua.SubscriptionAcknowledgement]) -> ua.PublishResponse:
        request = ua.PublishRequest()
        request.Parameters.SubscriptionAcknowledgements = acknowledged or []
        answer = await session._send_request(request, timeout=0)  # noqa: SLF001
        found = decoded(answer.copy())
        return found or await UaSession.publish(_Answered(session, answer), acknowledged)

    session.publish = publish


def decoded(answer: Buffer) -> ua.PublishResponse | None:
    """Return a publish response of plain changes; None where asyncua has to decode it."""
    try:
        found = read_response(answer.read(len(answer)), _item)
    except _UNREADABLE:
        return None
    return None if found is None else _as_asyncua(found)


def _item(body: bytes, at: int) -> tuple[ua.MonitoredItemNotification, int]:
    buffer = Buffer(body, at)
    item = struct_from_binary(ua.MonitoredItemNotification, buffer)
    return item, buffer.cur_pos


def _as_asyncua(found: PlainResponse[ua.MonitoredItemNotification]) -> ua.PublishResponse:
    message = ua.NotificationMessage(
        found.sequence, _BEGINS + timedelta(microseconds=found.published // 10), found.changes
    )
    parameters = ua.PublishResult(
        found.subscription,
        found.available,
        found.more,
        message,
        [ua.StatusCode(each) for each in found.results],
    )
    return ua.PublishResponse(Parameters=parameters)
