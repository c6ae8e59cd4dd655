"""Methods of the alarm (Part 9, 5.5 to 5.8): what a person calls becomes an order, which the agent obeys.

A method is answered when its order waits, the change follows as an event. ConfirmedState, OneShotShelve and
Disable have no counterpart in slipjump and are answered with BadNotSupported.
"""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Awaitable, Callable, Mapping, Sequence
from typing import Any

from asyncua import Server, ua

from connectors.base import Action, Order
from connectors.opcua_server.alarm.condition import Condition
from connectors.opcua_server.alarm.method import status, values_of
from connectors.opcua_server.caller import CALLER
from connectors.opcua_server.space.loop_view import LoopView
from connectors.opcua_server.space.names import Names

Ids, Codes = ua.ObjectIds, ua.StatusCodes
Work = Callable[[LoopView, Any, Any], Awaitable[ua.CallMethodResult]]
MOST_ORDERS = 100
"""Orders that may wait for the agent."""
PATIENCE = 10.0
"""Time in which the agent obeys an order, s: a second acknowledgement within it is too late."""


class Commands:
    """Answers the methods of all alarms of a server."""

    def __init__(
        self, server: Server, names: Names, views: Mapping[str, LoopView], longest_shelving: float
    ) -> None:
        """Take over the methods of the types.

        Args:
            server: Whose methods.
            names: Its node ids.
            views: By loop.
            longest_shelving: s.
        """
        self.orders: asyncio.Queue[Order] = asyncio.Queue(MOST_ORDERS)
        """Orders of operators."""
        self.taken = 0
        """Orders that were put into the queue."""
        self._acknowledged: dict[str, tuple[str | None, float]] = {}
        """Loop -> activation that was acknowledged last, and when, monotonic, s."""
        self._longest_shelving = longest_shelving
        self._views = {names.condition(loop): view for loop, view in views.items()}
        self._views |= {names.shelving(loop): view for loop, view in views.items()}
        machine = "ShelvedStateMachineType", "AlarmConditionType_ShelvingState"
        event, text, duration = ua.VariantType.ByteString, ua.VariantType.LocalizedText, ua.VariantType.Double
        self._link(server, ["AcknowledgeableConditionType_Acknowledge"], (event, text), self._acknowledge)
        self._link(server, ["ConditionType_AddComment"], (event, text), self._comment)
        for suffix, more in (("", ()), ("2", (text,))):
            self._link(server, [f"{m}_TimedShelve{suffix}" for m in machine], (duration, *more), self._shelve)
            self._link(server, [f"{m}_Unshelve{suffix}" for m in machine], (None, *more), self._unshelve)
            self._link(server, [f"AlarmConditionType_RemoveFromService{suffix}"], (None, *more), self._remove)
            self._link(server, [f"AlarmConditionType_PlaceInService{suffix}"], (None, *more), self._place)
        refused = [f"{m}_OneShotShelve{suffix}" for m in machine for suffix in ("", "2")]
        refused += ["AcknowledgeableConditionType_Confirm", "ConditionType_Enable", "ConditionType_Disable"]
        for name in refused:
            _answered(server, name, _not_supported)

    def _link(
        self, server: Server, names: Sequence[str], kinds: tuple[ua.VariantType | None, ...], work: Work
    ) -> None:
        """Let ``work`` answer methods; it gets two values, None for those that a method does not have."""
        first, *_ = kinds
        expected = [kind for kind in kinds if kind is not None]

        async def answer(of: ua.NodeId, *arguments: ua.Variant) -> ua.CallMethodResult:
            if not CALLER.get().user.may_order:
                return status(Codes.BadUserAccessDenied)
            view = self._views.get(of)
            if view is None:
                return status(Codes.BadNodeIdUnknown)
            values, refusal = values_of(arguments, expected)
            if refusal is not None:
                return refusal
            value = values.pop(0) if first is not None else None
            return await work(view, value, _text(values.pop() if values else None))

        for name in names:
            _answered(server, name, answer)

    async def _acknowledge(self, view: LoopView, event: bytes, comment: str) -> ua.CallMethodResult:
        condition = view.condition
        if event not in condition.event_ids:
            return status(Codes.BadEventIdUnknown)
        now, (activation, since) = time.monotonic(), self._acknowledged.get(condition.loop, (None, -math.inf))
        waits = activation == condition.activation and now - since < PATIENCE
        if condition.acked or waits:
            return status(Codes.BadConditionBranchAlreadyAcked)
        answer = self._order(view, "acknowledge", comment, alarm=condition.activation)
        if answer.StatusCode.is_good():
            self._acknowledged[condition.loop] = condition.activation, now
        return answer

    async def _comment(self, view: LoopView, event: bytes, comment: str) -> ua.CallMethodResult:
        if event not in view.condition.event_ids:
            return status(Codes.BadEventIdUnknown)
        await view.change(view.condition.commented(comment, CALLER.get().who, time.time()))
        return status(Codes.Good)

    async def _shelve(self, view: LoopView, duration: float, comment: str) -> ua.CallMethodResult:
        if view.condition.shelved:
            return status(Codes.BadConditionAlreadyShelved)
        if view.condition.out_of_service:
            return status(Codes.BadInvalidState)
        if not 0 < duration <= 1000 * self._longest_shelving:  # NaN is refused as well
            return status(Codes.BadShelvingTimeOutOfRange)
        return self._order(view, "shelve", comment, until=time.time() + duration / 1000)

    async def _unshelve(self, view: LoopView, _: None, comment: str) -> ua.CallMethodResult:
        if not view.condition.shelved:
            return status(Codes.BadConditionNotShelved)
        return self._order(view, "unshelve", comment)

    async def _remove(self, view: LoopView, _: None, comment: str) -> ua.CallMethodResult:
        if view.condition.out_of_service:
            return status(Codes.BadInvalidState)
        return self._order(view, "out_of_service", comment)

    async def _place(self, view: LoopView, _: None, comment: str) -> ua.CallMethodResult:
        if not view.condition.out_of_service:
            return status(Codes.BadInvalidState)
        return self._order(view, "in_service", comment)

    def _order(
        self,
        view: LoopView,
        action: Action,
        comment: str,
        *,
        until: float | None = None,
        alarm: str | None = None,
    ) -> ua.CallMethodResult:
        condition: Condition = view.condition
        who = CALLER.get().who
        try:
            self.orders.put_nowait(Order(condition.loop, action, who, until, alarm))
        except asyncio.QueueFull:
            return status(Codes.BadTooManyOperations)
        self.taken += 1
        if comment:
            view.condition = condition.remarked(comment, who, time.time())
        return status(Codes.Good)


def _answered(server: Server, name: str, answer: Callable[..., Awaitable[ua.CallMethodResult]]) -> None:
    """Let ``answer`` stand behind a standard method; asyncua's address space lacks some of the newest."""
    method = ua.NodeId(getattr(Ids, name))
    if method in server.iserver.aspace:
        server.iserver.isession.add_method_callback(method, answer)


async def _not_supported(*_: object) -> ua.CallMethodResult:
    return status(Codes.BadNotSupported)


def _text(comment: ua.LocalizedText | None) -> str:
    return "" if comment is None or comment.Text is None else str(comment.Text)[:1000]
