"""Sessions that show a method who calls it, which those of asyncua do not, and that know their limits."""

from __future__ import annotations

import math
import secrets
from contextvars import ContextVar
from typing import Any

from asyncua import ua
from asyncua.common.utils import ServiceError
from asyncua.server.internal_server import InternalServer
from asyncua.server.internal_session import InternalSession

from connectors.opcua_server.alarm.where import Where
from connectors.opcua_server.asyncua_private import monitored_items

CALLER: ContextVar[CallerSession] = ContextVar("caller")
"""Whose method call is being worked on."""
FASTEST, SLOWEST = 50.0, 60_000.0
"""Publishing intervals of subscriptions, ms; asyncua takes any, also ones that keep a core busy."""
MOST_ITEMS = 10_000
"""Monitored items of one subscription."""


class CallerSession(InternalSession):  # type: ignore[misc]
    """A client's session. Its token cannot be guessed: asyncua counts, and a token takes a session over."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:  # noqa: ANN401 - asyncua's own
        super().__init__(*args, **kwargs)
        self.client = ""
        """What the client calls itself."""
        if self.external:
            self.iserver.unregister_external_session(self)
            self.auth_token = ua.NodeId(secrets.token_bytes(32), 0)
            self.iserver.register_external_session(self)

    @property
    def who(self) -> str:
        """User, or, where nobody logged in, the client and its address."""
        if self.user.name:
            return str(self.user.name)
        address = self.name[0] if isinstance(self.name, tuple) else self.name
        return f"{self.client or 'OPC UA client'} ({address})"

    async def create_session(self, params: Any, sockname: Any = None) -> Any:  # noqa: ANN401
        """Remember what the client calls itself."""
        description = params.ClientDescription
        self.client = str((description.ApplicationName.Text or description.ApplicationUri or "")[:80])
        return await super().create_session(params, sockname)

    async def call(self, params: Any) -> Any:  # noqa: ANN401
        """Call methods in this session's name."""
        token = CALLER.set(self)
        try:
            return await super().call(params)
        finally:
            CALLER.reset(token)

    async def create_subscription(self, params: Any, *args: Any, **kwargs: Any) -> Any:  # noqa: ANN401
        """Keep the interval within bounds."""
        wanted = params.RequestedPublishingInterval
        params.RequestedPublishingInterval = (
            min(max(wanted, FASTEST), SLOWEST) if math.isfinite(wanted) else 1000.0
        )
        return await super().create_subscription(params, *args, **kwargs)

    async def create_monitored_items(self, params: Any) -> Any:  # noqa: ANN401
        """Keep their number within bounds, and let filters know subtypes."""
        subscription = self.subscription_service.subscriptions.get(params.SubscriptionId)
        if subscription is None:
            raise ServiceError(ua.StatusCodes.BadSubscriptionIdInvalid)
        items = monitored_items(subscription)
        if len(items) + len(params.ItemsToCreate) > MOST_ITEMS:
            raise ServiceError(ua.StatusCodes.BadTooManyMonitoredItems)
        results = await super().create_monitored_items(params)
        for result in results:
            item = items.get(result.MonitoredItemId)
            if item is not None and item.where_clause_evaluator is not None:
                item.where_clause_evaluator = Where(self.logger, self.aspace, item.filter.WhereClause)
        return results


class CallerServer(InternalServer):  # type: ignore[misc]
    """Makes such sessions, and keeps no list of other servers, which anybody could fill without a session."""

    def create_session(self, name: Any, user: Any = None, external: bool = False) -> CallerSession:  # noqa: ANN401, FBT001, FBT002
        """Make a session of a client."""
        known = {} if user is None else {"user": user}
        return CallerSession(self, self.aspace, self.subscription_service, name, external=external, **known)

    def register_server(self, server: Any, conf: Any = None) -> None:  # noqa: ANN401, ARG002
        """Refuse: this is no discovery server."""
        raise ServiceError(ua.StatusCodes.BadServiceUnsupported)
